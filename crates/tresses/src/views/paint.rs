//! Colors for values that are composited over the finished frame.

use crate::Camera;
use bytemuck::{Pod, Zeroable};
use glam::Mat4;

/// Range of values for colors, and opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Paint {
    /// Value drawn darkest, in the unit of the quantity.
    pub low: f32,
    /// Value drawn brightest.
    pub high: f32,
    /// Opacity. For slices and lines 0..1; for a volume the optical depth of one meter with the value `high`, 1/m.
    pub opacity: f32,
}

/// Shader data of [`Paint`], and of the camera.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct PaintUniform {
    /// Clip space to world space.
    pub inverse: Mat4,
    /// [`Paint::low`].
    pub low: f32,
    /// [`Paint::high`].
    pub high: f32,
    /// [`Paint::opacity`].
    pub opacity: f32,
    /// 1 if the shader applies the sRGB curve, 0 if the format of the output does.
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
