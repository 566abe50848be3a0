//! What is measured while its owner goes on: on a thread of its own, where there are threads.

use std::{
    future::pending,
    panic::resume_unwind,
    pin::pin,
    sync::{
        Arc, Mutex, OnceLock, PoisonError,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    task::{Context, Poll, Waker},
    thread::{self, JoinHandle},
};

use crate::Progress;

/// A value that may still be on its way. Who asks first waits for it.
#[derive(Debug)]
pub(super) struct Later<T> {
    value: OnceLock<T>,
    /// Gives nothing once nobody wants it any more.
    thread: Mutex<Option<JoinHandle<Option<T>>>>,
    wanted: Wanted,
}

/// The listener of the work: holds it up for good when nobody wants its result.
#[derive(Clone, Debug)]
pub(super) struct Wanted(Arc<AtomicBool>);

impl Progress for Wanted {
    async fn step(&self, _task: &'static str, _fraction: f32) {
        if !self.0.load(Relaxed) {
            pending().await
        }
    }
}

impl<T> Later<T> {
    /// A value that is there.
    pub fn known(value: T) -> Self {
        Self { value: value.into(), thread: Mutex::new(None), wanted: Wanted(Arc::new(true.into())) }
    }

    /// What `work` gives, which waits for nothing but the listener that it gets.
    #[cfg_attr(target_arch = "wasm32", allow(dead_code))] // There are no threads.
    pub fn start<W: AsyncFnOnce(&Wanted) -> T + Send + 'static>(work: W) -> Self
    where
        T: Send + 'static,
    {
        let wanted = Wanted(Arc::new(true.into()));
        let listener = wanted.clone();
        let measure = move || {
            let done = pin!(work(&listener)).poll(&mut Context::from_waker(Waker::noop()));
            if let Poll::Ready(value) = done { Some(value) } else { None }
        };
        Self { value: OnceLock::new(), thread: Mutex::new(Some(thread::spawn(measure))), wanted }
    }

    /// The value. Blocks until it is there.
    pub fn get(&self) -> &T {
        self.value.get_or_init(|| {
            let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
            let value = thread.expect("either the value is known or its thread").join();
            value.unwrap_or_else(|panic| resume_unwind(panic)).expect("whoever asks wants it")
        })
    }
}

impl<T> Drop for Later<T> {
    fn drop(&mut self) {
        self.wanted.0.store(false, Relaxed);
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn whoever_asks_waits() {
        let (go, gone) = channel();
        let later = Later::start(async move |_| gone.recv().unwrap_or(0));
        assert!(later.value.get().is_none());
        go.send(7).unwrap();
        assert_eq!((later.get(), later.get()), (&7, &7));
        assert_eq!(Later::known(3).get(), &3);
    }

    #[test]
    fn work_that_nobody_wants_ends() {
        let (go, gone) = channel::<()>();
        let (tell, told) = channel();
        let later = Later::start(async move |wanted: &Wanted| {
            let _ = gone.recv();
            wanted.step("", 0.0).await;
            tell.send(()).unwrap();
        });
        drop(later);
        drop(go);
        assert!(told.recv().is_err(), "the work went on");
    }
}
