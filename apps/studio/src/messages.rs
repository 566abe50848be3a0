//! Messages for the user.

use tresses_scene::words::sentence;

/// The current messages.
#[derive(Clone, Debug, Default)]
pub struct Messages {
    /// The last error.
    pub error: Option<String>,
    /// The last result.
    pub notice: Option<String>,
}

impl Messages {
    /// Removes all messages.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Shows `error` with its causes.
    pub fn fail(&mut self, error: impl Into<anyhow::Error>) {
        self.error = Some(sentence(&error.into()));
    }
}
