//! Background computation, where the platform has threads.

#[cfg(not(target_arch = "wasm32"))]
use std::{panic::resume_unwind, thread};

/// A value that a thread computes.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) struct BackgroundTask<T>(thread::JoinHandle<T>);

/// A value.
#[cfg(target_arch = "wasm32")]
pub(crate) struct BackgroundTask<T>(T);

#[cfg(not(target_arch = "wasm32"))]
impl<T: Send + 'static> BackgroundTask<T> {
    /// Starts `work`.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Self {
        Self(thread::spawn(work))
    }

    /// Returns the result. Blocks until it is ready.
    pub fn get(self) -> T {
        self.0.join().unwrap_or_else(|panic| resume_unwind(panic))
    }
}

#[cfg(target_arch = "wasm32")]
impl<T> BackgroundTask<T> {
    pub fn start(work: impl FnOnce() -> T) -> Self {
        Self(work())
    }

    pub fn get(self) -> T {
        self.0
    }
}
