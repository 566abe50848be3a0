//! The camera, and what it makes of light.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::math::Ray;

/// From linear radiance to the picture's 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneMap {
    /// Factor before everything else.
    pub exposure: f32,
    /// Below this the picture is linear; above it is compressed so that it never reaches 1.
    pub shoulder: f32,
    /// How fast colours brighter than the shoulder fade to white.
    pub desaturation: f32,
}

impl Default for ToneMap {
    fn default() -> Self {
        Self { exposure: 1.0, shoulder: 0.7, desaturation: 0.15 }
    }
}

/// A camera and the size of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World to view space: right-handed, looking along -Z, metres.
    pub view: Mat4,
    /// View to clip space. Depth runs from 1 (near) down to 0 (far), so that the precision of
    /// floating-point depth is spent evenly.
    pub projection: Mat4,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
}

impl Default for Camera {
    /// A portrait of a head whose eyes are 1.55 m above the ground.
    fn default() -> Self {
        Self::look_at(Vec3::new(0.3, 1.6, 0.72), Vec3::new(0.0, 1.52, 0.0), 26f32.to_radians(), [960, 600])
    }
}

impl Camera {
    /// A perspective camera at `eye` that looks at `target` (metres) with the vertical field of
    /// view `fov_y` (radians), upright. The near plane is at 1 cm, the far plane at infinity.
    pub fn look_at(eye: Vec3, target: Vec3, fov_y: f32, size: [u32; 2]) -> Self {
        let aspect = size[0].max(1) as f32 / size[1].max(1) as f32;
        Self {
            view: glam::camera::rh::view::look_at_mat4(eye, target, Vec3::Y),
            projection: Self::perspective(fov_y, aspect, 0.01),
            size,
        }
    }

    /// A perspective projection with reversed depth and no far plane: vertical field of view
    /// (radians), width over height, distance of the near plane (metres).
    pub fn perspective(fov_y: f32, aspect: f32, near: f32) -> Mat4 {
        let focal = 1.0 / (0.5 * fov_y).tan();
        Mat4::from_cols_array_2d(&[
            [focal / aspect, 0.0, 0.0, 0.0],
            [0.0, focal, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, near, 0.0],
        ])
    }

    /// Where the camera is, metres.
    pub fn eye(&self) -> Vec3 {
        self.view.inverse().w_axis.truncate()
    }

    /// The ray from the camera through a place of the picture, pixels from its left and upper edge.
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let [width, height] = self.size.map(|side| side.max(1) as f32);
        let inverse = (self.projection * self.view).inverse();
        // Depth is reversed, and 0 may be at infinity.
        let at =
            |depth| inverse.project_point3(Vec3::new(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height, depth));
        let (near, far) = (at(1.0), at(0.5));
        Ray { origin: near, direction: (far - near).normalize_or(Vec3::NEG_Z) }
    }

    /// The height of a pixel (metres) at a point whose clip coordinate `w` is 1: for a perspective
    /// camera at a distance of 1 m, for an orthographic one anywhere.
    pub fn pixel(&self) -> f32 {
        2.0 / (self.projection.y_axis.y.abs() * self.size[1].max(1) as f32)
    }

    pub(crate) fn uniform(&self, samples: u32, ssaa: u32) -> CameraUniform {
        CameraUniform {
            view_projection: self.projection * self.view,
            eye: self.eye(),
            pixel: self.pixel() / ssaa as f32,
            size: Vec2::new(self.size[0] as f32, self.size[1] as f32),
            samples,
            ssaa,
            // Depth is (c z + a) / (d z + b) of the view's z. Solved for z, and two of them subtracted: what
            // is left does not suffer from the camera being far away.
            way: {
                let (a, b) = (self.projection.w_axis.z, self.projection.w_axis.w);
                let (c, d) = (self.projection.z_axis.z, self.projection.z_axis.w);
                Vec4::new(c, d, a * d - b * c, 0.0)
            },
        }
    }
}

/// What the shaders know of a [`Camera`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CameraUniform {
    /// World to clip space.
    pub view_projection: Mat4,
    /// Where the camera is, metres.
    pub eye: Vec3,
    /// See [`Camera::pixel`]; of the supersampled target.
    pub pixel: f32,
    /// Width and height of the picture, pixels.
    pub size: Vec2,
    /// Samples per pixel of the target.
    pub samples: u32,
    /// Target pixels per picture pixel along each axis.
    pub ssaa: u32,
    /// From depth `s` to depth `t` the view goes `z (t - s) / ((x - y s) (x - y t))` metres on.
    pub way: Vec4,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_a_pixel() {
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 0.5, [300, 200]);
        let clip = |p: Vec3| camera.projection * camera.view * p.extend(1.0);
        let pixel = camera.pixel() * clip(Vec3::ZERO).w;
        let height = |p: Vec3| clip(p).y / clip(p).w * 0.5 * 200.0;
        assert!((height(Vec3::Y * pixel) - 1.0).abs() < 1e-4);
        assert!((camera.eye() - Vec3::Z * 2.0).length() < 1e-5);
        let depth = |p: Vec3| clip(p).z / clip(p).w;
        let point = Vec3::new(0.31, -0.12, 0.2);
        let at = clip(point).truncate() / clip(point).w;
        let ray = camera.ray((0.5 + 0.5 * at.x) * 300.0, (0.5 - 0.5 * at.y) * 200.0);
        assert!((point - ray.origin).reject_from_normalized(ray.direction).length() < 1e-4);
        assert!(ray.direction.dot(Vec3::NEG_Z) > 0.9);
        assert!((depth(Vec3::Z * 1.99) - 1.0).abs() < 1e-4 && depth(Vec3::Z * -1e6) < 1e-6);
    }
}
