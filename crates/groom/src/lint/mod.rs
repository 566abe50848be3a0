//! The groom lint: what is unusual about a groom, where, and what is done about it.
//!
//! After [`repair`] every strand has at least two vertices, at most
//! [`MAX_STRAND_VERTICES`](crate::MAX_STRAND_VERTICES), finite numbers and segments of at least
//! [`MIN_SEGMENT`]. All measures are in metres, so a groom is oriented first.

mod check;
mod repair;
mod stats;

pub use check::{Finding, Kind, Report, Severity, check};
pub(crate) use repair::repair_kept;
pub use repair::{Repaired, repair};
pub use stats::Spread;

/// The shortest segment that stays, metres: a seventh of a hair's diameter.
pub const MIN_SEGMENT: f32 = 1e-5;
/// The shortest strand that stays, metres.
pub const MIN_STRAND: f32 = 1e-4;
