//! The page: a canvas instead of a window.

use crate::{app::Studio, device, options::Options, state};
use std::panic;
use wasm_bindgen::{JsCast, JsValue, prelude::*};

/// Where the page says in words what the canvas cannot show.
const MESSAGE: &str = "message";

/// The button that loads the page again.
const AGAIN: &str = "again";

/// Starts the studio in `canvas`, as the page's address has it ([`Options::of`]). Fails with one sentence
/// where it is wrong, or the browser has no WebGPU.
#[wasm_bindgen]
pub async fn start(canvas: web_sys::HtmlCanvasElement) -> Result<(), JsValue> {
    expose()?;
    let wanted = query()?;
    let wanted = wanted.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    let wanted = Options::of(wanted).map_err(|error| format!("{error:#}"))?;
    let options = eframe::WebOptions { wgpu_options: device::configuration(), ..Default::default() };
    let create: eframe::AppCreator<'static> =
        Box::new(|context| Ok(Box::new(Studio::new(context, wanted)?) as Box<dyn eframe::App>));
    let runner = eframe::WebRunner::new();
    say_panics();
    runner.start(canvas, options, create).await
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

/// Names and values behind the question mark of the page's address.
fn query() -> Result<Vec<(String, String)>, JsValue> {
    let Some(window) = web_sys::window() else { return Ok(Vec::new()) };
    let pairs = web_sys::UrlSearchParams::new_with_str(&window.location().search()?)?;
    let text = |pair: &JsValue, i| js_sys::Array::from(pair).get(i).as_string().unwrap_or_default();
    Ok(js_sys::Array::from(&pairs).iter().map(|pair| (text(&pair, 0), text(&pair, 1))).collect())
}

/// How long bytes of a download are kept for the browser to take, milliseconds.
const TAKEN: i32 = 60_000;

/// Has the browser download `bytes` as the file `name`.
///
/// # Errors
/// What the browser says.
pub(crate) fn download(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let window = web_sys::window().ok_or("there is no window")?;
    let document = window.document().ok_or("there is no document")?;
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let kind = web_sys::BlobPropertyBag::new();
    kind.set_type("application/octet-stream");
    let blob = web_sys::Blob::new_with_u8_array_sequence_and_options(&parts, &kind)?;
    let url = web_sys::Url::create_object_url_with_blob(&blob)?;
    let link: web_sys::HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&url);
    link.set_download(name);
    link.click();
    let forget = Closure::once_into_js(move || web_sys::Url::revoke_object_url(&url));
    window.set_timeout_with_callback_and_timeout_and_arguments_0(forget.unchecked_ref(), TAKEN)?;
    Ok(())
}

/// Says a sentence over the canvas, for whatever happens after which nothing is drawn any more.
pub(crate) fn say(sentence: &str) {
    let element = web_sys::window()
        .and_then(|window| window.document())
        .and_then(|document| document.get_element_by_id(MESSAGE));
    let Some(element) = element else { return };
    element.set_text_content(Some(sentence));
    // Otherwise the page stays as it is: there is nowhere else to say it.
    let _ = element.remove_attribute("hidden");
    let again = web_sys::window().and_then(|window| window.document()?.get_element_by_id(AGAIN));
    if let Some(again) = again {
        let _ = again.remove_attribute("hidden");
    }
}

/// After a panic, which the console has in full, the page says that it has ended.
fn say_panics() {
    let before = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        before(info);
        say("The studio has ended because of an error of its own, which the browser's console shows.");
    }));
}
