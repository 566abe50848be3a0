//! Progress on the terminal; silent where the output is not one.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar over `frames` frames.
pub fn frames(what: &'static str, frames: u64) -> ProgressBar {
    let bar = ProgressBar::new(frames).with_message(what);
    let template = "{msg} {wide_bar} {pos}/{len} frames, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// A line that turns while something of unknown length goes on.
pub fn spinner(what: &'static str) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_message(what);
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar
}
