//! Errors on the CPU side, each one sentence that names the place and, where there is one, the remedy.

use std::path::PathBuf;

/// The result of this crate's fallible calls.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Where in a file something is wrong.
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

/// What can go wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be opened, read or written.
    #[error("{path}: {source}", path = .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is not what it should be.
    #[error("{path}{at}: {problem}", path = .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Where in it.
        at: At,
        /// One clause.
        problem: String,
    },
    /// A groom or a mesh cannot be used.
    #[error("{0}")]
    Unusable(String),
    /// A parameter is outside its range.
    #[error("{name} is {value}, but must be {range}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: String,
        /// What is allowed, in words.
        range: &'static str,
    },
}

impl Error {
    /// [`Error::Parameter`] unless `value` is a number from `least` to `most`; `range` says so in words.
    ///
    /// # Errors
    /// That one.
    pub fn unless_within(
        name: &'static str,
        value: f32,
        least: f32,
        most: f32,
        range: &'static str,
    ) -> Result<()> {
        if (least..=most).contains(&value) {
            return Ok(());
        }
        Err(Self::Parameter { name, value: value.to_string(), range })
    }
}
