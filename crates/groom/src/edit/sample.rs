//! Points of a stroke.

use super::solve::unit;
use crate::{Error, Result};
use glam::Vec3;

/// A point of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeSample {
    /// The eye, or the middle of the brush without a camera; groom space, meters.
    pub origin: Vec3,
    /// Direction of sight through the pointer; zero without a camera.
    pub direction: Vec3,
    /// Pressure of the pen, 0 to 1; 1 without a pen.
    pub pressure: f32,
    /// Time since the press, s. Some tools also act while the brush stands still.
    pub time: f32,
}

impl StrokeSample {
    /// Creates a sample of a mouse: the ray from the eye through the pointer.
    pub fn ray(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction: unit(direction, Vec3::NEG_Z), pressure: 1.0, time: 0.0 }
    }

    /// Creates a sample without a camera: the middle of the brush.
    pub fn point(at: Vec3) -> Self {
        Self { origin: at, direction: Vec3::ZERO, pressure: 1.0, time: 0.0 }
    }

    pub(super) fn at(&self, depth: f32) -> Vec3 {
        self.origin + self.direction * depth
    }

    /// Whether the pointer has moved since `self` to `other`, by a thousandth of the distance.
    pub(super) fn differs_from(&self, other: &Self) -> bool {
        let is_at = |a: Vec3, b: Vec3, near: f32| a.distance_squared(b) < near * near;
        !(is_at(self.direction, other.direction, 1e-3) && is_at(self.origin, other.origin, 1e-3))
    }

    pub(super) fn lerp(&self, other: &Self, t: f32) -> Self {
        let direction = self.direction.lerp(other.direction, t);
        Self {
            origin: self.origin.lerp(other.origin, t),
            direction: unit(direction, Vec3::ZERO),
            pressure: self.pressure + (other.pressure - self.pressure) * t,
            time: other.time,
        }
    }

    /// Checks that all numbers are finite and near.
    pub(super) fn check(&self) -> Result<()> {
        let StrokeSample { origin, direction, pressure, time } = self;
        let is_finite = origin.is_finite() && direction.is_finite() && (pressure + time).is_finite();
        if is_finite && origin.abs().max_element() < 1e3 {
            return Ok(());
        }
        Err(Error::Parameter { name: "the stroke", value: format!("{self:?}"), range: "within a kilometer" })
    }
}
