//! The groom lint. It reports unusual properties of a groom, their location, and the importer's action.
//!
//! After [`repair`] every strand has at least two vertices, at most
//! [`MAX_STRAND_VERTICES`](crate::MAX_STRAND_VERTICES), finite numbers and segments of at least [`MIN_SEGMENT`]. All
//! measures are in meters, so a groom must be oriented first.

mod check;
mod repair;
mod stats;

pub use check::{Finding, FindingKind, LintReport, Severity, check};
pub use repair::{RepairReport, repair, repair_kept};
pub use stats::Spread;

/// Minimum length of a segment after repair, meters: a seventh of a hair's diameter.
pub const MIN_SEGMENT: f32 = 1e-5;
/// Minimum length of a strand after repair, meters.
pub const MIN_STRAND: f32 = 1e-4;
