//! Errors. Each is one sentence that names the place and, where there is one, the remedy.

use crate::groom;

/// Result of the library's fallible functions.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Errors of the library.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file, groom or mesh is unusable.
    #[error(transparent)]
    Groom(groom::Error),
    /// The colliders are unusable.
    #[error("colliders: {0}")]
    Colliders(String),
    /// A buffer or texture exceeds the adapter's limits.
    #[error("{what} needs {need} {unit}, but this adapter allows {have}")]
    Limit {
        /// The resource.
        what: &'static str,
        /// Size needed.
        need: u64,
        /// Size allowed.
        have: u64,
        /// Unit of both, such as `bytes in one buffer`.
        unit: &'static str,
    },
    /// A parameter is out of range, including parameters of the groom.
    #[error("{name} is {value}, but must be {range}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// The given value.
        value: String,
        /// Allowed range, in words.
        range: &'static str,
    },
    /// No adapter was found, or none is sufficient.
    #[error("{0}")]
    Adapter(String),
    /// wgpu reported an error: a bug of this crate, or a lost device.
    #[error("the GPU reported an error in {stage}: {problem}")]
    Gpu {
        /// The stage or resource.
        stage: &'static str,
        /// wgpu's message.
        problem: String,
    },
}

impl Error {
    /// Returns the error for an unusable groom or mesh.
    pub(crate) fn unusable(problem: impl Into<String>) -> Self {
        Self::Groom(groom::Error::Unusable(problem.into()))
    }

    /// Returns [`Error::Parameter`] unless `value` is a number from `min` to `max`. `range` is the range in words.
    pub(crate) fn unless_within(
        name: &'static str,
        value: f32,
        min: f32,
        max: f32,
        range: &'static str,
    ) -> Result<()> {
        Ok(groom::Error::unless_within(name, value, min, max, range)?)
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
