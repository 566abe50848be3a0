//! Background work: a thread natively, an async task in the browser.

/// Runs the future that `make` returns in the background.
#[cfg(not(target_arch = "wasm32"))]
pub fn spawn<W: Future<Output = ()>>(make: impl FnOnce() -> W + Send + 'static) {
    // The same stack size as the main thread: parsers and tree builders recurse.
    let thread = std::thread::Builder::new().name("studio work".into()).stack_size(8 << 20);
    if let Err(error) = thread.spawn(move || pollster::block_on(make())) {
        eprintln!("no thread could be started: {error}");
    }
}

/// Runs the future that `make` returns in the background.
#[cfg(target_arch = "wasm32")]
pub fn spawn<W: Future<Output = ()> + 'static>(make: impl FnOnce() -> W + 'static) {
    wasm_bindgen_futures::spawn_local(make());
}

/// Does nothing: a thread does not block the window.
#[cfg(not(target_arch = "wasm32"))]
pub async fn breathe() {}

/// Lets the page draw before the work continues.
#[cfg(target_arch = "wasm32")]
pub async fn breathe() {
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        if let Some(window) = web_sys::window() {
            // Two frames at 60 Hz: the page paints in between.
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, 32);
        }
    });
    let _ = wasm_bindgen_futures::JsFuture::from(promise).await;
}
