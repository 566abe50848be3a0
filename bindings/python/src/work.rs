//! Long work: without the interpreter's lock, with a callback that hears of it, and until somebody presses Ctrl-C.

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

/// How often signals are looked for and the callback hears of one and the same task.
const PACE: Duration = Duration::from_millis(50);

/// Who is told of work, and what ended it before it was done.
pub struct Teller {
    callback: Option<Py<PyAny>>,
    state: Mutex<State>,
}

struct State {
    task: &'static str,
    told: Option<Instant>,
    failed: Option<PyErr>,
}

impl Teller {
    fn state(&self) -> MutexGuard<'_, State> {
        // A panic elsewhere leaves values that are still true.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells the callback and looks for signals; whether the work is to go on.
    fn tell(&self, task: &'static str, fraction: f32) -> bool {
        {
            let mut state = self.state();
            let now = Instant::now();
            let soon = state.told.is_some_and(|told| now - told < PACE);
            if soon && state.task == task {
                return state.failed.is_none();
            }
            (state.task, state.told) = (task, Some(now));
        }
        let told = Python::attach(|py| -> PyResult<()> {
            py.check_signals()?;
            if let Some(callback) = &self.callback {
                callback.call1(py, (task, f64::from(fraction.clamp(0.0, 1.0))))?;
            }
            Ok(())
        });
        self.keep(told)
    }

    /// Looks for signals.
    pub fn look(&self) -> PyResult<()> {
        Python::attach(|py| py.check_signals())
    }

    fn keep(&self, told: PyResult<()>) -> bool {
        match told {
            Ok(()) => true,
            Err(error) => {
                self.state().failed = Some(error);
                false
            }
        }
    }
}

impl Progress for Teller {
    async fn step(&self, task: &'static str, fraction: f32) {
        if !self.tell(task, fraction) {
            // Whoever polls the work finds out why it waits, and drops it.
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

/// Does `work` to its end without the interpreter's lock; `callback` is told of it: a task in words, and how much of it is
/// done, 0 to 1.
pub fn run<T: Send>(
    py: Python<'_>,
    callback: Option<Py<PyAny>>,
    work: impl AsyncFnOnce(&Teller) -> anyhow::Result<T> + Send,
) -> PyResult<T> {
    py.detach(|| {
        let state = State { task: "", told: None, failed: None };
        let teller = Teller { callback, state: Mutex::new(state) };
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
