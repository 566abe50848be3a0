//! JavaScript interface: the studio in a canvas.

use crate::{
    answer::{Answer, Read},
    app::Studio,
    device,
    dialog::Dialogs,
    hosted::Command,
    options::Options,
    page, pen, sort,
    state::{self, State},
};
use std::{cell::RefCell, panic, rc::Rc};
use tresses_scene::words::sentence;
use wasm_bindgen::{JsCast, JsValue, prelude::*};

/// A studio in a canvas, with its panels or as an embedded viewer.
#[wasm_bindgen]
pub struct Viewer {
    runner: eframe::WebRunner,
    dialogs: Dialogs,
    /// The last state; `None` before the first frame.
    state: Rc<RefCell<Option<State>>>,
}

#[wasm_bindgen]
impl Viewer {
    /// Opens the studio in `canvas`. `query` is the query string of an address ([`Options::of`]). `files` is an array
    /// of alternating names and `Uint8Array`s to show first. `hides_panels` hides everything but the viewport.
    /// `on_change` is called with the state as JSON whenever it changes, except for fields that change every frame.
    /// Fails with one sentence if an argument is invalid or the browser has no WebGPU.
    pub async fn open(
        canvas: web_sys::HtmlCanvasElement,
        query: String,
        files: js_sys::Array,
        hides_panels: bool,
        on_change: js_sys::Function,
    ) -> Result<Viewer, JsValue> {
        let parameters = pairs(&query)?;
        let parameters = parameters.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        let mut options =
            Options::of(parameters).map_err(|error| sentence(&error.context("the page's address")))?;
        options.hides_panels = hides_panels;
        // Companion files are loaded after the groom.
        let mut deferred = Vec::new();
        for answer in sort::files(read(&files), true) {
            match answer {
                Answer::Open(files) if options.given.is_none() => options.given = Some(files),
                answer => deferred.push(answer),
            }
        }
        let web = eframe::WebOptions { wgpu_options: device::configuration(), ..Default::default() };
        let state = Rc::new(RefCell::new(None));
        let opened: Rc<RefCell<Option<Dialogs>>> = Rc::default();
        let create: eframe::AppCreator<'static> = {
            let (state, opened) = (state.clone(), opened.clone());
            Box::new(move |context| {
                let mut studio = Studio::new(context, options)?;
                *opened.borrow_mut() = Some(studio.dialogs.clone());
                studio.host.tell = Some(Box::new(move |now| tell(now, &state, &on_change)));
                Ok(Box::new(studio) as Box<dyn eframe::App>)
            })
        };
        pen::follow(&canvas)?;
        let runner = eframe::WebRunner::new();
        runner.start(canvas, web, create).await?;
        let dialogs = opened.take().ok_or("the studio did not open")?;
        deferred.into_iter().for_each(|answer| dialogs.tell(answer));
        Ok(Self { runner, dialogs, state })
    }

    /// Shows other files, an array of alternating names and `Uint8Array`s, as if they were dropped.
    pub fn load(&self, files: js_sys::Array) {
        for answer in sort::files(read(&files), true) {
            self.dialogs.tell(answer);
        }
    }

    /// Sets `playing`, `motion`, `animation`, `camera` or a parameter by its path.
    pub fn set(&self, name: &str, value: &str) -> Result<(), JsValue> {
        let command = Command::of(name, value).map_err(|error| sentence(&error))?;
        self.dialogs.tell(Answer::Do(command));
        Ok(())
    }

    /// Returns the state as JSON.
    pub fn state(&self) -> String {
        self.state.borrow().as_ref().map_or_else(|| "{}".into(), text)
    }

    /// Closes the studio and frees the canvas.
    pub fn close(self) {
        self.runner.destroy();
    }
}

/// Reads an array of alternating names and bytes.
fn read(files: &js_sys::Array) -> Vec<Read> {
    let bytes = |value: JsValue| js_sys::Uint8Array::new(&value).to_vec();
    let name = |value: JsValue| value.as_string().unwrap_or_default().into();
    (0..files.length() / 2).map(|i| (name(files.get(2 * i)), bytes(files.get(2 * i + 1)))).collect()
}

/// Returns a state as JSON.
fn text(state: &State) -> String {
    serde_json::to_string(state).unwrap_or_default()
}

/// Calls `on_change` if the state has changed in a field that does not change every frame.
fn tell(now: &State, state: &RefCell<Option<State>>, on_change: &js_sys::Function) {
    let before = state.replace(Some(now.clone())).unwrap_or_default();
    // Leave out the fields that change every frame.
    let lasting = |state: &State| {
        let State { strands, file, companion_files, step, error, playing, size, adapter, lost, .. } =
            state.clone();
        let shown = u64::from(state.displayed_frame > 0);
        State {
            strands,
            file,
            companion_files,
            step,
            error,
            playing,
            size,
            adapter,
            lost,
            displayed_frame: shown,
            ..Default::default()
        }
    };
    if lasting(&before) != lasting(now) {
        // An error thrown by the callback is in the console.
        let _ = on_change.call1(&JsValue::NULL, &text(now).into());
    }
}

/// Opens the whole studio in `canvas` with `files` and the query of the page's address.
#[wasm_bindgen]
pub async fn start(
    canvas: web_sys::HtmlCanvasElement,
    query: String,
    files: js_sys::Array,
) -> Result<Viewer, JsValue> {
    expose()?;
    say_panics();
    Viewer::open(canvas, query, files, false, js_sys::Function::new_no_args("")).await
}

/// Returns the studio's state as JSON.
#[wasm_bindgen]
pub fn tresses_state() -> String {
    state::json()
}

/// Defines `window.tresses_state()` for tests that drive the page.
fn expose() -> Result<(), JsValue> {
    let Some(window) = web_sys::window() else { return Ok(()) };
    let tell = Closure::<dyn Fn() -> String>::new(state::json);
    js_sys::Reflect::set(&window, &"tresses_state".into(), tell.as_ref().unchecked_ref())?;
    tell.forget();
    Ok(())
}

/// Parses names and values of a query.
fn pairs(query: &str) -> Result<Vec<(String, String)>, JsValue> {
    let pairs = web_sys::UrlSearchParams::new_with_str(query)?;
    let text = |pair: &JsValue, i| js_sys::Array::from(pair).get(i).as_string().unwrap_or_default();
    Ok(js_sys::Array::from(&pairs).iter().map(|pair| (text(&pair, 0), text(&pair, 1))).collect())
}

/// Shows a message on the page after a panic. The console has the details.
fn say_panics() {
    let before = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        before(info);
        page::say("The studio has crashed; the browser's console shows the error.");
    }));
}
