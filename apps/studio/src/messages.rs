//! Messages for the user.

use std::fmt::Display;

/// The current messages.
#[derive(Clone, Debug, Default)]
pub struct Messages {
    /// The last error.
    pub error: Option<String>,
    /// The last result.
    pub said: Option<String>,
}

impl Messages {
    /// Removes all messages.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Shows `error` with its causes.
    pub fn fail(&mut self, error: impl Display) {
        self.error = Some(format!("{error:#}"));
    }
}
