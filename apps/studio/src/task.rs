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
    // Two frames at 60 Hz: the page paints in between.
    pause(32).await;
}

/// Waits for some milliseconds.
#[cfg(target_arch = "wasm32")]
pub async fn pause(milliseconds: i32) {
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        if let Some(window) = web_sys::window() {
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, milliseconds);
        }
    });
    let _ = wasm_bindgen_futures::JsFuture::from(promise).await;
}
