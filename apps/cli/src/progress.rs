//! Progress on the terminal. Silent if the output is not a terminal.

use indicatif::{ProgressBar, ProgressStyle, WeakProgressBar};
use std::{
    cell::Cell,
    sync::{Mutex, PoisonError},
    time::Duration,
};
use tresses::Progress;

/// The bar on the terminal, for [`clear`].
static CURRENT_BAR: Mutex<Option<WeakProgressBar>> = Mutex::new(None);

/// Records `bar` as the one that [`clear`] removes, and returns it.
fn set_current(bar: ProgressBar) -> ProgressBar {
    *CURRENT_BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.downgrade());
    bar
}

/// Removes the bar from the terminal before the program exits.
pub fn clear() {
    let current = CURRENT_BAR.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(bar) = current.and_then(|bar| bar.upgrade()) {
        bar.finish_and_clear();
    }
}

fn set_template(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
}

/// Shows and returns a bar with `message` that counts to `frames`.
pub fn frames(message: &'static str, frames: u64) -> ProgressBar {
    let bar = ProgressBar::new(frames).with_message(message);
    set_template(&bar, "{msg} {wide_bar} {pos}/{len} frames, {eta} left");
    set_current(bar)
}

/// Length of a bar that shows a fraction.
const STEPS: u64 = 1000;

/// Progress of one task at a time: a spinner, or a bar with the remaining time once the task reports a fraction.
pub struct TaskProgress {
    bar: ProgressBar,
    task: Cell<&'static str>,
    /// Whether the task has reported a fraction, so that the bar replaces the spinner.
    has_fraction: Cell<bool>,
}

impl TaskProgress {
    /// Shows `task` as the first task.
    pub fn new(task: &'static str) -> Self {
        let preparing = Self {
            bar: set_current(ProgressBar::new(STEPS)),
            task: Cell::new(""),
            has_fraction: Cell::new(false),
        };
        preparing.start_task(task);
        preparing.bar.enable_steady_tick(Duration::from_millis(100));
        preparing
    }

    /// Shows `task` with a spinner, in place of the task before.
    pub fn start_task(&self, task: &'static str) {
        self.task.set(task);
        self.has_fraction.set(false);
        self.bar.reset();
        set_template(&self.bar, "{spinner} {msg}, {elapsed}");
        self.bar.set_message(task);
    }

    /// Hides the bar while `print` writes to the terminal.
    pub fn suspend(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }
}

impl Drop for TaskProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for TaskProgress {
    async fn step(&self, task: &'static str, fraction: f32) {
        if task != self.task.get() {
            self.start_task(task);
        }
        if fraction > 0.0 && !self.has_fraction.replace(true) {
            set_template(&self.bar, "{msg} {wide_bar} {eta} left");
        }
        self.bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f32) as u64);
    }
}
