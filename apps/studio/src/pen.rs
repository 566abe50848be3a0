//! Pressure of pens on a page: egui reports the pressure of fingers alone.

use std::cell::Cell;
use wasm_bindgen::{JsCast, JsValue, prelude::*};

thread_local! {
    static PRESSURE: Cell<Option<f32>> = const { Cell::new(None) };
}

/// Follows the pointers on `canvas`.
///
/// # Errors
/// Returns the browser's error.
pub(crate) fn follow(canvas: &web_sys::EventTarget) -> Result<(), JsValue> {
    let note = Closure::<dyn Fn(web_sys::PointerEvent)>::new(|event: web_sys::PointerEvent| {
        let is_pen = event.pointer_type() == "pen";
        // A pen that hovers has no pressure; the window may still have to draw the end of its stroke.
        if !is_pen || event.pressure() > 0.0 {
            PRESSURE.set(is_pen.then(|| event.pressure()));
        }
    });
    for name in ["pointerdown", "pointermove"] {
        // Before egui, which stops some events.
        canvas.add_event_listener_with_callback_and_bool(name, note.as_ref().unchecked_ref(), true)?;
    }
    note.forget();
    Ok(())
}

/// Returns the pressure of the pen, 0 to 1; `None` for a mouse or a finger.
pub(crate) fn pressure() -> Option<f32> {
    PRESSURE.get()
}
