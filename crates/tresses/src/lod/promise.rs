//! Values computed in the background, on a thread where the platform has threads.

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

/// A value that may still be being computed. [`get`](Self::get) waits for it.
#[derive(Debug)]
pub(super) struct Promise<T> {
    value: OnceLock<T>,
    /// Returns `None` if the work was abandoned.
    thread: Mutex<Option<JoinHandle<Option<T>>>>,
    cancel_token: CancelToken,
}

/// The work's progress listener. Suspends the work forever once its result is no longer wanted.
#[derive(Clone, Debug)]
pub(super) struct CancelToken(Arc<AtomicBool>);

impl Progress for CancelToken {
    async fn step(&self, _task: &'static str, _fraction: f32) {
        if !self.0.load(Relaxed) {
            pending().await
        }
    }
}

impl<T> Promise<T> {
    /// Creates a value that is already computed.
    pub fn known(value: T) -> Self {
        Self {
            value: value.into(),
            thread: Mutex::new(None),
            cancel_token: CancelToken(Arc::new(true.into())),
        }
    }

    /// Starts `work` on a thread. `work` may await nothing but the listener that it receives.
    #[cfg_attr(target_arch = "wasm32", allow(dead_code))] // wasm32 has no threads.
    pub fn start<W: AsyncFnOnce(&CancelToken) -> T + Send + 'static>(work: W) -> Self
    where
        T: Send + 'static,
    {
        let cancel_token = CancelToken(Arc::new(true.into()));
        let listener = cancel_token.clone();
        let measure = move || {
            let done = pin!(work(&listener)).poll(&mut Context::from_waker(Waker::noop()));
            if let Poll::Ready(value) = done { Some(value) } else { None }
        };
        Self { value: OnceLock::new(), thread: Mutex::new(Some(thread::spawn(measure))), cancel_token }
    }

    /// Returns the value. Blocks until it is computed.
    pub fn get(&self) -> &T {
        self.value.get_or_init(|| {
            let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
            let value = thread.expect("the value or its thread is set").join();
            value
                .unwrap_or_else(|panic| resume_unwind(panic))
                .expect("the work is not canceled while a caller waits")
        })
    }
}

impl<T> Drop for Promise<T> {
    fn drop(&mut self) {
        self.cancel_token.0.store(false, Relaxed);
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn get_blocks_until_value_is_ready() {
        let (go, gone) = channel();
        let later = Promise::start(async move |_| gone.recv().unwrap_or(0));
        assert!(later.value.get().is_none());
        go.send(7).unwrap();
        assert_eq!((later.get(), later.get()), (&7, &7));
        assert_eq!(Promise::known(3).get(), &3);
    }

    #[test]
    fn dropping_later_stops_its_work() {
        let (go, gone) = channel::<()>();
        let (tell, told) = channel();
        let later = Promise::start(async move |wanted: &CancelToken| {
            let _ = gone.recv();
            wanted.step("", 0.0).await;
            tell.send(()).unwrap();
        });
        drop(later);
        drop(go);
        assert!(told.recv().is_err(), "the work went on");
    }
}
