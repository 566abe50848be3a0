//! Rays.

use glam::Vec3;

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Its beginning, metres.
    pub origin: Vec3,
    /// Its direction, of any length but zero.
    pub direction: Vec3,
}
