//! Progress on the terminal. Silent if the output is not a terminal.

use indicatif::{ProgressBar, ProgressStyle, WeakProgressBar};
use std::{
    cell::Cell,
    sync::{Mutex, PoisonError},
    time::Duration,
};
use tresses::Progress;

/// The current bar.
static SHOWN: Mutex<Option<WeakProgressBar>> = Mutex::new(None);

fn shown(bar: ProgressBar) -> ProgressBar {
    *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.downgrade());
    bar
}

/// Removes the bar from the terminal before the program exits.
pub fn clear() {
    let shown = SHOWN.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(bar) = shown.and_then(|bar| bar.upgrade()) {
        bar.finish_and_clear();
    }
}

fn styled(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
}

/// Shows a bar of `frames` frames.
pub fn frames(what: &'static str, frames: u64) -> ProgressBar {
    let bar = ProgressBar::new(frames).with_message(what);
    styled(&bar, "{msg} {wide_bar} {pos}/{len} frames, {eta} left");
    shown(bar)
}

/// Resolution of a bar that shows a fraction.
const STEPS: u64 = 1000;

/// Progress of the preparation: a spinner, or a bar with the remaining time once a task reports its fraction.
pub struct Preparing {
    bar: ProgressBar,
    task: Cell<&'static str>,
    is_measured: Cell<bool>,
}

impl Preparing {
    /// Shows the first task.
    pub fn new(task: &'static str) -> Self {
        let preparing =
            Self { bar: shown(ProgressBar::new(STEPS)), task: Cell::new(""), is_measured: Cell::new(false) };
        preparing.task(task);
        preparing.bar.enable_steady_tick(Duration::from_millis(100));
        preparing
    }

    /// Shows `task` with a spinner.
    pub fn task(&self, task: &'static str) {
        self.task.set(task);
        self.is_measured.set(false);
        self.bar.reset();
        styled(&self.bar, "{spinner} {msg}, {elapsed}");
        self.bar.set_message(task);
    }

    /// Hides the bar while `tell` writes to the terminal.
    pub fn suspend(&self, tell: impl FnOnce()) {
        self.bar.suspend(tell);
    }
}

impl Drop for Preparing {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Preparing {
    async fn step(&self, task: &'static str, fraction: f32) {
        if task != self.task.get() {
            self.task(task);
        }
        if fraction > 0.0 && !self.is_measured.replace(true) {
            styled(&self.bar, "{msg} {wide_bar} {eta} left");
        }
        self.bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f32) as u64);
    }
}
