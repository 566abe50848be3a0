//! Compositing of values as colours over the finished picture.

use crate::Camera;
use bytemuck::{Pod, Zeroable};
use glam::Mat4;

/// Which numbers have which colours, and how much of the picture shows through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// The number that is drawn darkest, in the unit of what is shown.
    pub low: f32,
    /// The number that is drawn brightest.
    pub high: f32,
    /// How opaque it is: of slices and lines 0..1; of a volume the optical depth of one metre of
    /// `high`, 1/m.
    pub opacity: f32,
}

/// What the shaders of the debug views know of [`Paint`] and of the picture.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct PaintUniform {
    /// Clip space to the world.
    pub inverse: Mat4,
    /// [`Paint::low`].
    pub low: f32,
    /// [`Paint::high`].
    pub high: f32,
    /// [`Paint::opacity`].
    pub opacity: f32,
    /// 1 when the shader applies the sRGB curve, 0 when the output's format does.
    pub encode: u32,
}

impl PaintUniform {
    pub(super) fn new(paint: &Paint, camera: &Camera, encode: bool) -> Self {
        Self {
            inverse: (camera.projection * camera.view).inverse(),
            low: paint.low,
            high: paint.high,
            opacity: paint.opacity,
            encode: u32::from(encode),
        }
    }
}
