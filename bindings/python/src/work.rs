//! Long operations: they release the GIL, report progress to a callback, and stop on Ctrl-C.

use crate::raised;
use pyo3::prelude::*;
use std::{
    pin::pin,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    task::{Context, Poll, Wake, Waker},
    thread::{self, Thread},
    time::{Duration, Instant},
};
use tresses::Progress;

/// Interval between checks for signals, and between progress callbacks for the same task.
const PACE: Duration = Duration::from_millis(50);

/// Reports progress to the callback, and stores the exception that interrupted the work.
pub struct ProgressCallback {
    callback: Option<Py<PyAny>>,
    state: Mutex<State>,
}

struct State {
    task: &'static str,
    last_report: Option<Instant>,
    failed: Option<PyErr>,
}

impl ProgressCallback {
    fn state(&self) -> MutexGuard<'_, State> {
        // The state stays valid even after a panic in another thread.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls the callback and checks for signals. Returns whether the work should continue.
    fn tell(&self, task: &'static str, fraction: f32) -> bool {
        {
            let mut state = self.state();
            let now = Instant::now();
            let soon = state.last_report.is_some_and(|last_report| now - last_report < PACE);
            if soon && state.task == task {
                return state.failed.is_none();
            }
            (state.task, state.last_report) = (task, Some(now));
        }
        let result = Python::attach(|py| -> PyResult<()> {
            py.check_signals()?;
            if let Some(callback) = &self.callback {
                callback.call1(py, (task, f64::from(fraction.clamp(0.0, 1.0))))?;
            }
            Ok(())
        });
        self.keep(result)
    }

    /// Checks for signals.
    pub fn look(&self) -> PyResult<()> {
        Python::attach(|py| py.check_signals())
    }

    fn keep(&self, result: PyResult<()>) -> bool {
        match result {
            Ok(()) => true,
            Err(error) => {
                self.state().failed = Some(error);
                false
            }
        }
    }
}

impl Progress for ProgressCallback {
    async fn step(&self, task: &'static str, fraction: f32) {
        if !self.tell(task, fraction) {
            // `run` sees the error while this future is pending, and drops the work.
            std::future::pending::<()>().await;
        }
    }
}

struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Runs `work` to completion without the GIL. `callback` receives the current task in words and its fraction, 0 to 1.
pub fn run<T: Send>(
    py: Python<'_>,
    callback: Option<Py<PyAny>>,
    work: impl AsyncFnOnce(&ProgressCallback) -> anyhow::Result<T> + Send,
) -> PyResult<T> {
    py.detach(|| {
        let state = State { task: "", last_report: None, failed: None };
        let teller = ProgressCallback { callback, state: Mutex::new(state) };
        let mut future = pin!(work(&teller));
        let waker = Waker::from(Arc::new(Unpark(thread::current())));
        loop {
            match future.as_mut().poll(&mut Context::from_waker(&waker)) {
                Poll::Ready(done) => return done.map_err(raised),
                Poll::Pending => {
                    if let Some(error) = teller.state().failed.take() {
                        return Err(error);
                    }
                    thread::park_timeout(PACE);
                    teller.look()?;
                }
            }
        }
    })
}
