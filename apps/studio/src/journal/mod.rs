//! The journal: the last version of groomed hair, for the case that the studio ends before the user saves it.

#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(not(target_arch = "wasm32"))]
mod disk;

#[cfg(target_arch = "wasm32")]
pub use browser::{BrowserGroom as LeftGroom, BrowserJournal as Journal, find};
#[cfg(not(target_arch = "wasm32"))]
pub use disk::{Journal, LeftGroom, find};

use std::time::Duration;

/// Returns how long ago something was, in words.
fn age(elapsed: Duration) -> String {
    match elapsed.as_secs() / 60 {
        0 => "less than a minute ago".into(),
        1 => "a minute ago".into(),
        minutes @ 2..120 => format!("{minutes} minutes ago"),
        minutes @ 120..2880 => format!("{} hours ago", minutes / 60),
        minutes => format!("{} days ago", minutes / 1440),
    }
}
