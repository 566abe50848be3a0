//! Background work: a thread natively, an async task in the browser.

/// Starts the work that `make` makes and returns.
#[cfg(not(target_arch = "wasm32"))]
pub fn spawn<W: Future<Output = ()>>(make: impl FnOnce() -> W + Send + 'static) {
    // As much stack as the main thread has: readers and trees recurse.
    let thread = std::thread::Builder::new().name("studio work".into()).stack_size(8 << 20);
    if let Err(error) = thread.spawn(move || pollster::block_on(make())) {
        eprintln!("no thread could be started: {error}");
    }
}

/// Starts the work that `make` makes and returns.
#[cfg(target_arch = "wasm32")]
pub fn spawn<W: Future<Output = ()> + 'static>(make: impl FnOnce() -> W + 'static) {
    wasm_bindgen_futures::spawn_local(make());
}

/// Lets the page draw; a thread has no need to.
#[cfg(not(target_arch = "wasm32"))]
pub async fn breathe() {}

/// Lets the page draw before work goes on.
#[cfg(target_arch = "wasm32")]
pub async fn breathe() {
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        if let Some(window) = web_sys::window() {
            // Twice the length of a frame: the page paints in between.
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, 32);
        }
    });
    let _ = wasm_bindgen_futures::JsFuture::from(promise).await;
}
