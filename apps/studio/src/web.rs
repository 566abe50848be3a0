//! The page: a canvas instead of a window.

use crate::{app::Studio, device, options::Options, state};
use wasm_bindgen::{JsCast, JsValue, prelude::*};

/// Starts the studio in `canvas`. Fails with one sentence where the browser has no WebGPU.
#[wasm_bindgen]
pub async fn start(canvas: web_sys::HtmlCanvasElement) -> Result<(), JsValue> {
    expose()?;
    let options = eframe::WebOptions { wgpu_options: device::configuration(), ..Default::default() };
    let create: eframe::AppCreator<'static> =
        Box::new(|context| Ok(Box::new(Studio::new(context, Options::default())?) as Box<dyn eframe::App>));
    eframe::WebRunner::new().start(canvas, options, create).await
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
