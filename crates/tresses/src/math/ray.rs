//! Rays.

use glam::Vec3;

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Starting point, meters.
    pub origin: Vec3,
    /// Direction, of any nonzero length.
    pub direction: Vec3,
}
