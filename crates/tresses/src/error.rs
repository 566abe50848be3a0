//! Errors, each one sentence that names the place and, where there is one, the remedy.

use crate::groom;
pub use groom::error::At;

/// The result of the library's fallible calls.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file, a groom or a mesh cannot be used.
    #[error(transparent)]
    Groom(groom::Error),
    /// Colliders cannot be used as they are.
    #[error("colliders: {0}")]
    Colliders(String),
    /// The adapter's limits are too small.
    #[error("{what} needs {need} bytes in one buffer, but this adapter allows {have}")]
    Limit {
        /// What needs them.
        what: &'static str,
        /// Bytes needed.
        need: u64,
        /// Bytes allowed.
        have: u64,
    },
    /// A parameter is outside its range, the groom's included.
    #[error("{name} is {value}, but must be {range}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: String,
        /// What is allowed, in words.
        range: &'static str,
    },
    /// No adapter, or none that will do.
    #[error("{0}")]
    Adapter(String),
    /// wgpu refused something: a bug of this crate, or a lost device.
    #[error("the GPU refused {stage}: {problem}")]
    Gpu {
        /// The stage or resource.
        stage: &'static str,
        /// What wgpu said.
        problem: String,
    },
}

impl Error {
    /// A groom or a mesh cannot be used.
    pub(crate) fn unusable(problem: impl Into<String>) -> Self {
        Self::Groom(groom::Error::Unusable(problem.into()))
    }

    /// [`Error::Parameter`] unless `value` is a number from `least` to `most`; `range` says so in words.
    pub(crate) fn unless_within(
        name: &'static str,
        value: f32,
        least: f32,
        most: f32,
        range: &'static str,
    ) -> Result<()> {
        Ok(groom::Error::unless_within(name, value, least, most, range)?)
    }
}

impl From<groom::Error> for Error {
    fn from(error: groom::Error) -> Self {
        match error {
            groom::Error::Parameter { name, value, range } => Self::Parameter { name, value, range },
            error => Self::Groom(error),
        }
    }
}
