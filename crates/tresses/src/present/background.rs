//! The background: a soft gradient, a flat color, or nothing.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The background. `present` composites it in linear light.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Background {
    /// Linear radiance behind the head.
    pub center: Vec3,
    /// 1 for a transparent image (premultiplied alpha), else 0.
    pub transparent: u32,
    /// Linear radiance toward the corners of the image.
    pub edge: Vec3,
    /// Distance from the center at which the edge's radiance is reached, in image heights.
    pub falloff: f32,
}

impl Default for Background {
    /// A quiet blue-gray, lighter behind the head.
    fn default() -> Self {
        Self {
            center: Vec3::new(0.115, 0.125, 0.14),
            transparent: 0,
            edge: Vec3::new(0.028, 0.031, 0.037),
            falloff: 1.0,
        }
    }
}

impl Background {
    /// One color (linear radiance) everywhere.
    pub fn flat(color: Vec3) -> Self {
        Self { center: color, transparent: 0, edge: color, falloff: 1.0 }
    }

    /// A transparent background: the image has an alpha channel.
    pub fn transparent() -> Self {
        Self { transparent: 1, ..Self::flat(Vec3::ZERO) }
    }
}
