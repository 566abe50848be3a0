//! Work that goes on beside other work, where there are threads.

#[cfg(not(target_arch = "wasm32"))]
use std::{panic::resume_unwind, thread};

/// A value on its way.
#[cfg(not(target_arch = "wasm32"))]
pub struct Aside<T>(thread::JoinHandle<T>);

/// A value.
#[cfg(target_arch = "wasm32")]
pub struct Aside<T>(T);

#[cfg(not(target_arch = "wasm32"))]
impl<T: Send + 'static> Aside<T> {
    /// Begins `work`.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Self {
        Self(thread::spawn(work))
    }

    /// What it gives. Blocks until it is done.
    pub fn get(self) -> T {
        self.0.join().unwrap_or_else(|panic| resume_unwind(panic))
    }
}

#[cfg(target_arch = "wasm32")]
impl<T> Aside<T> {
    pub fn start(work: impl FnOnce() -> T) -> Self {
        Self(work())
    }

    pub fn get(self) -> T {
        self.0
    }
}
