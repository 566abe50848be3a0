//! Error log of frames.

use bevy::log::error;
use std::collections::BTreeSet;

/// Logs each message once, because an error in one frame usually repeats in the next.
#[derive(Debug, Default)]
pub(crate) struct ErrorLog(BTreeSet<String>);

impl ErrorLog {
    pub fn report(&mut self, message: String) {
        if !self.0.contains(&message) {
            error!("{message}");
            self.0.insert(message);
        }
    }
}
