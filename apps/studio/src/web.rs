//! The page: a canvas instead of a window.

use crate::{
    answer::{Answer, Read},
    app::Studio,
    device,
    dialog::Dialogs,
    hosted::Command,
    options::Options,
    page, sort,
    state::{self, State},
};
use std::{cell::RefCell, panic, rc::Rc};
use wasm_bindgen::{JsCast, JsValue, prelude::*};

/// A studio in a canvas: the whole of it, or nothing but its picture in a page of others.
#[wasm_bindgen]
pub struct Viewer {
    runner: eframe::WebRunner,
    dialogs: Dialogs,
    /// How it is, once there was a frame.
    state: Rc<RefCell<Option<State>>>,
}

#[wasm_bindgen]
impl Viewer {
    /// Opens it in `canvas`. `query` is as behind the question mark of an address ([`Options::of`]), `files` an array of
    /// names and `Uint8Array`s in turn, which are shown first, `bare` for nothing but the picture. `told` is called with
    /// the state as JSON whenever that has changed, but for what changes in every frame. Fails with one sentence where
    /// something is wrong, or the browser has no WebGPU.
    pub async fn open(
        canvas: web_sys::HtmlCanvasElement,
        query: String,
        files: js_sys::Array,
        bare: bool,
        told: js_sys::Function,
    ) -> Result<Viewer, JsValue> {
        let wanted = pairs(&query)?;
        let wanted = wanted.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        let mut options = Options::of(wanted).map_err(|error| format!("{error:#}"))?;
        options.bare = bare;
        // Those that are no groom follow once it is there.
        let mut later = Vec::new();
        for answer in sort::files(read(&files), true) {
            match answer {
                Answer::Open(files) if options.given.is_none() => options.given = Some(files),
                answer => later.push(answer),
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
                studio.host.tell = Some(Box::new(move |now| tell(now, &state, &told)));
                Ok(Box::new(studio) as Box<dyn eframe::App>)
            })
        };
        let runner = eframe::WebRunner::new();
        runner.start(canvas, web, create).await?;
        let dialogs = opened.take().ok_or("the studio did not open")?;
        later.into_iter().for_each(|answer| dialogs.tell(answer));
        Ok(Self { runner, dialogs, state })
    }

    /// Shows other files: names and `Uint8Array`s in turn, as if they were dropped.
    pub fn load(&self, files: js_sys::Array) {
        for answer in sort::files(read(&files), true) {
            self.dialogs.tell(answer);
        }
    }

    /// Sets `playing`, `motion`, `animation`, `camera` or a parameter by its path.
    pub fn set(&self, name: &str, value: &str) -> Result<(), JsValue> {
        let command = Command::of(name, value).map_err(|error| format!("{error:#}"))?;
        self.dialogs.tell(Answer::Do(command));
        Ok(())
    }

    /// How things are, as JSON.
    pub fn state(&self) -> String {
        self.state.borrow().as_ref().map_or_else(|| "{}".into(), text)
    }

    /// Ends it; the canvas is free again.
    pub fn close(self) {
        self.runner.destroy();
    }
}

/// Names and bytes, in turn.
fn read(files: &js_sys::Array) -> Vec<Read> {
    let bytes = |value: JsValue| js_sys::Uint8Array::new(&value).to_vec();
    let name = |value: JsValue| value.as_string().unwrap_or_default().into();
    (0..files.length() / 2).map(|i| (name(files.get(2 * i)), bytes(files.get(2 * i + 1)))).collect()
}

/// A state as JSON.
fn text(state: &State) -> String {
    serde_json::to_string(state).unwrap_or_default()
}

/// Tells a page of `now` if anything of it has changed that does not change in every frame.
fn tell(now: &State, state: &RefCell<Option<State>>, told: &js_sys::Function) {
    let before = state.replace(Some(now.clone())).unwrap_or_default();
    // What changes all the time is left out of the comparison.
    let lasting = |state: &State| {
        let State { strands, file, companions, step, error, playing, size, adapter, lost, .. } =
            state.clone();
        let shown = u64::from(state.seen > 0);
        State {
            strands,
            file,
            companions,
            step,
            error,
            playing,
            size,
            adapter,
            lost,
            seen: shown,
            ..Default::default()
        }
    };
    if lasting(&before) != lasting(now) {
        // What a page's own function throws is in the console.
        let _ = told.call1(&JsValue::NULL, &text(now).into());
    }
}

/// Opens the whole studio in `canvas` with `files`, as the page's address has it.
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

/// What the studio tells of itself, as JSON.
#[wasm_bindgen]
pub fn tresses_state() -> String {
    state::json()
}

/// `window.tresses_state()` for tests that drive the page.
fn expose() -> Result<(), JsValue> {
    let Some(window) = web_sys::window() else { return Ok(()) };
    let tell = Closure::<dyn Fn() -> String>::new(state::json);
    js_sys::Reflect::set(&window, &"tresses_state".into(), tell.as_ref().unchecked_ref())?;
    tell.forget();
    Ok(())
}

/// Names and values of a query.
fn pairs(query: &str) -> Result<Vec<(String, String)>, JsValue> {
    let pairs = web_sys::UrlSearchParams::new_with_str(query)?;
    let text = |pair: &JsValue, i| js_sys::Array::from(pair).get(i).as_string().unwrap_or_default();
    Ok(js_sys::Array::from(&pairs).iter().map(|pair| (text(&pair, 0), text(&pair, 1))).collect())
}

/// After a panic, which the console has in full, the page says that it has ended.
fn say_panics() {
    let before = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        before(info);
        page::say("The studio has ended because of an error of its own, which the browser's console shows.");
    }));
}
