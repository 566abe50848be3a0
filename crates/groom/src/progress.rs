//! Progress of long operations on the CPU, which also yield to other work.
//!
//! Long functions take a [`Progress`] and are `async`; most have a synchronous variant without it.

use std::{
    pin::pin,
    sync::{Mutex, PoisonError},
    task::{Context, Poll, Waker},
};

/// A listener to long operations, which it may also suspend: a web page must return to the event loop several times a
/// second, and a window updates a progress bar. The work calls [`step`](Self::step) every few milliseconds. A listener
/// whose way of waiting is slow should wait only when some time has passed since it last did.
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
    /// Reports that `task` (a few words, lower case) is running and that `fraction` (0 to 1) of it is done. The work
    /// waits until the future is ready.
    fn step(&self, task: &'static str, fraction: f32) -> impl Future<Output = ()>;
}

/// Ignores all reports.
impl Progress for () {
    async fn step(&self, _task: &'static str, _fraction: f32) {}
}

impl<P: Progress> Progress for &P {
    fn step(&self, task: &'static str, fraction: f32) -> impl Future<Output = ()> {
        (*self).step(task, fraction)
    }
}

/// Returns the number of threads for long operations: as many as the machine runs at once, one in a browser.
pub fn threads() -> usize {
    match cfg!(target_arch = "wasm32") {
        true => 1,
        false => std::thread::available_parallelism().map_or(1, |count| count.get()),
    }
}

/// Returns `of(item)` for every item, in order. The items are shared among [`threads`].
pub(crate) fn in_parallel<T: Sync, R: Send>(items: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = threads().min(items.len());
    if threads < 2 {
        return items.iter().map(of).collect();
    }
    let parts: Vec<_> = items.chunks(items.len().div_ceil(threads)).collect();
    let done: Vec<_> = parts.iter().map(|_| Mutex::new(Vec::new())).collect();
    let lock = |i: usize| done[i].lock().unwrap_or_else(PoisonError::into_inner);
    on_threads(parts.len(), &|i| {
        let results = parts[i].iter().map(&of).collect();
        *lock(i) = results;
    });
    done.into_iter().flat_map(|part| part.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

/// Calls `work(i)` for `i` from 0 to `count`, each on a thread of its own. Compiled once, unlike its generic caller.
///
/// # Panics
/// If a call panics, with its message.
fn on_threads(count: usize, work: &(dyn Fn(usize) + Sync)) {
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..count).map(|i| scope.spawn(move || work(i))).collect();
        for thread in threads {
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        }
    });
}

/// Returns the value of a future that is ready when it is first polled: one without a waiting [`Progress`] and without
/// read-back.
///
/// # Panics
/// If the future waits.
pub fn at_once<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => unreachable!("the future is not ready at its first poll"),
    }
}
