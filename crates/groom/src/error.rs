//! Errors of this crate. Each message is one sentence that names the place and, where there is one, the remedy.

use std::path::PathBuf;

/// Result type of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Position of an error in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// The file as a whole.
    File,
    /// A byte offset from the start of a binary file.
    Byte(u64),
    /// A line of a text file, counted from 1.
    Line(u64),
}

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            At::File => Ok(()),
            At::Byte(offset) => write!(f, " at byte {offset}"),
            At::Line(line) => write!(f, " at line {line}"),
        }
    }
}

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be opened, read or written.
    #[error("{path}: {source}", path = .path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error from the operating system.
        source: std::io::Error,
    },
    /// A file is invalid.
    #[error("{path}{at}: {problem}", path = .path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Position in the file.
        at: At,
        /// Problem, as one clause.
        problem: String,
    },
    /// A groom or a mesh cannot be used.
    #[error("{0}")]
    Unusable(String),
    /// A parameter is outside its range.
    #[error("{name} is {value}, but must be {range}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Rejected value.
        value: String,
        /// Allowed range, in words.
        range: &'static str,
    },
}

impl Error {
    /// Checks that `value` is a number from `min` to `max`. `range` is that range in words.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it is not.
    pub fn unless_within(
        name: &'static str,
        value: f32,
        min: f32,
        max: f32,
        range: &'static str,
    ) -> Result<()> {
        if (min..=max).contains(&value) {
            return Ok(());
        }
        Err(Self::Parameter { name, value: value.to_string(), range })
    }
}
