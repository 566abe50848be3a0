//! The page outside the canvas: downloads and error messages.

use wasm_bindgen::{JsCast, JsValue, prelude::*};

/// Id of the element for messages that the canvas cannot show.
const MESSAGE: &str = "message";

/// Id of the button that reloads the page.
const AGAIN: &str = "again";

/// How long the bytes of a download are kept, milliseconds.
const DOWNLOAD_LIFETIME: i32 = 60_000;

/// Makes the browser download `bytes` as the file `name`.
///
/// # Errors
/// Returns the browser's error.
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
    window
        .set_timeout_with_callback_and_timeout_and_arguments_0(forget.unchecked_ref(), DOWNLOAD_LIFETIME)?;
    Ok(())
}

/// Shows a message over the canvas, for errors after which nothing can be drawn.
pub(crate) fn say(sentence: &str) {
    let element = web_sys::window()
        .and_then(|window| window.document())
        .and_then(|document| document.get_element_by_id(MESSAGE));
    let Some(element) = element else { return };
    element.set_text_content(Some(sentence));
    // Ignore an error: the page has no other place for the message.
    let _ = element.remove_attribute("hidden");
    let again = web_sys::window().and_then(|window| window.document()?.get_element_by_id(AGAIN));
    if let Some(again) = again {
        let _ = again.remove_attribute("hidden");
    }
}
