//! Progress of long operations on the CPU, which also yield to other work.
//!
//! Long functions take a [`Progress`] and are `async`; most have a twin without both.

use std::{
    pin::pin,
    task::{Context, Poll, Waker},
};

/// Who listens to long work, and may hold it up: a browser's page must give the event loop its turn
/// several times a second, a window wants a bar that moves. It is told every few milliseconds; a listener
/// whose way of waiting takes long does well to wait only when some time has passed since it last did.
///
/// ```
/// struct Printed;
///
/// impl tresses_groom::Progress for Printed {
///     async fn step(&self, task: &'static str, fraction: f32) {
///         println!("{task}: {:.0} %", 100.0 * fraction);
///     }
/// }
/// ```
pub trait Progress {
    /// `task` (a few words, lower case) goes on now, `fraction` (0 to 1) of it being done. The work
    /// waits until the future is ready.
    fn step(&self, task: &'static str, fraction: f32) -> impl Future<Output = ()>;
}

/// Nobody listens.
impl Progress for () {
    async fn step(&self, _task: &'static str, _fraction: f32) {}
}

impl<P: Progress> Progress for &P {
    fn step(&self, task: &'static str, fraction: f32) -> impl Future<Output = ()> {
        (*self).step(task, fraction)
    }
}

/// How many threads long work is divided among: as many as the machine runs at once, one in a browser.
pub fn threads() -> usize {
    match cfg!(target_arch = "wasm32") {
        true => 1,
        false => std::thread::available_parallelism().map_or(1, |count| count.get()),
    }
}

/// What a future gives that is ready when it is first polled: one without a [`Progress`] that waits and
/// without read-back.
///
/// # Panics
/// When the future waits.
pub fn at_once<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => unreachable!("nothing in it waits"),
    }
}
