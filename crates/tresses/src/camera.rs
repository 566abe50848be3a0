//! The camera and its tone mapping.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::math::Ray;

/// Share of the image's height or width that a framed subject fills.
const FILL: f32 = 0.9;

/// Height that a portrait shows below the top of the hair or head, meters: a head with its chin.
const HEAD_HEIGHT: f32 = 0.27;

/// Maps linear radiance to display values from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneMap {
    /// Exposure: factor applied to the radiance first.
    pub exposure: f32,
    /// Start of the shoulder: the mapping is linear below it and compresses values above it so that they never reach 1.
    pub shoulder: f32,
    /// How fast colors brighter than the shoulder fade to white.
    pub desaturation: f32,
}

impl Default for ToneMap {
    fn default() -> Self {
        Self { exposure: 1.0, shoulder: 0.7, desaturation: 0.15 }
    }
}

/// A box: smallest and largest corner, meters.
pub type Bounds = (Vec3, Vec3);

/// A camera and the size of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World to view space, meters. View space is right-handed; the camera looks along -Z.
    pub view: Mat4,
    /// View to clip space with reversed depth: 1 at the near plane, 0 at the far plane. Reversing spreads the precision
    /// of floating-point depth evenly.
    pub projection: Mat4,
    /// Width and height of the image, pixels.
    pub size: [u32; 2],
}

impl Default for Camera {
    /// A portrait of a head whose eyes are 1.55 m above the ground.
    fn default() -> Self {
        Self::look_at(Vec3::new(0.3, 1.6, 0.72), Vec3::new(0.0, 1.52, 0.0), 26f32.to_radians(), [960, 600])
    }
}

impl Camera {
    /// Creates an upright perspective camera at `eye` that looks at `target` (meters). `fov_y` is the vertical field of
    /// view in radians. The near plane is at 1 cm, the far plane at infinity.
    pub fn look_at(eye: Vec3, target: Vec3, fov_y: f32, size: [u32; 2]) -> Self {
        let aspect = size[0].max(1) as f32 / size[1].max(1) as f32;
        Self {
            view: glam::camera::rh::view::look_at_mat4(eye, target, Vec3::Y),
            projection: Self::perspective(fov_y, aspect, 0.01),
            size,
        }
    }

    /// Creates a camera that shows all of `subject` (lowest and highest corner, meters) from `direction`, a unit vector
    /// from the subject to the camera.
    pub fn framing(subject: Bounds, direction: Vec3, fov_y: f32, size: [u32; 2]) -> Self {
        let aspect = size[0].max(1) as f32 / size[1].max(1) as f32;
        let center = 0.5 * (subject.0 + subject.1);
        let eye = center + direction * framing_distance(subject, direction, fov_y, aspect);
        Self::look_at(eye, center, fov_y, size)
    }

    /// Returns a perspective projection with reversed depth and no far plane. `fov_y` is the vertical field of view in
    /// radians, `aspect` width over height, `near` the distance of the near plane in meters.
    pub fn perspective(fov_y: f32, aspect: f32, near: f32) -> Mat4 {
        let focal = 1.0 / (0.5 * fov_y).tan();
        Mat4::from_cols_array_2d(&[
            [focal / aspect, 0.0, 0.0, 0.0],
            [0.0, focal, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, near, 0.0],
        ])
    }

    /// Returns the position of the camera, meters.
    pub fn eye(&self) -> Vec3 {
        self.view.inverse().w_axis.truncate()
    }

    /// Returns the ray through a point of the image, in pixels from its upper left corner.
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let [width, height] = self.size.map(|side| side.max(1) as f32);
        let inverse = (self.projection * self.view).inverse();
        // Depth is reversed, and depth 0 may lie at infinity.
        let at =
            |depth| inverse.project_point3(Vec3::new(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height, depth));
        let (near, far) = (at(1.0), at(0.5));
        Ray { origin: near, direction: (far - near).normalize_or(Vec3::NEG_Z) }
    }

    /// Returns the height of a pixel (meters) at a point whose clip coordinate `w` is 1: at a distance of 1 m for a
    /// perspective camera, anywhere for an orthographic one.
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
            // Depth as a function of view z is (c z + a) / (d z + b). Solving for z and subtracting two of them
            // analytically avoids the cancellation that a distant camera would cause.
            depth_to_distance: {
                let (a, b) = (self.projection.w_axis.z, self.projection.w_axis.w);
                let (c, d) = (self.projection.z_axis.z, self.projection.z_axis.w);
                Vec4::new(c, d, a * d - b * c, 0.0)
            },
        }
    }
}

/// A [`Camera`] as shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CameraUniform {
    /// World to clip space.
    pub view_projection: Mat4,
    /// Position of the camera, meters.
    pub eye: Vec3,
    /// [`Camera::pixel`] of the supersampled target.
    pub pixel: f32,
    /// Width and height of the image, pixels.
    pub size: Vec2,
    /// MSAA samples per target pixel.
    pub samples: u32,
    /// Target pixels per image pixel along each axis.
    pub ssaa: u32,
    /// Coefficients that convert depth differences to meters. From depth `s` to depth `t`, a view ray advances
    /// `z (t - s) / ((x - y s) (x - y t))` meters.
    pub depth_to_distance: Vec4,
}

/// Returns the distance to the middle of `subject` from which it fills 0.9 of the image's height or width. `direction`
/// is a unit vector from the subject to the camera, `fov_y` the vertical field of view in radians, `aspect` width over
/// height.
pub fn framing_distance(subject: Bounds, direction: Vec3, fov_y: f32, aspect: f32) -> f32 {
    let right = Vec3::new(direction.z, 0.0, -direction.x).normalize_or(Vec3::X);
    let up = direction.cross(right);
    let half = 0.5 * (subject.1 - subject.0);
    let tan = (0.5 * fov_y).tan() * FILL;
    // Fit an elliptic cylinder rather than the box, because no hairstyle reaches the corners of its box. The cylinder
    // is narrower at top and bottom, because the point nearest to the camera is seldom there.
    (0..32)
        .flat_map(|i| {
            let angle = i as f32 / 16.0 * std::f32::consts::PI;
            let rim = |r: f32, y: f32| half * Vec3::new(r * angle.cos(), y, r * angle.sin());
            let wide = rim(1.0, 0.0);
            let high = [-1.0, 1.0].map(|y| rim(0.7, y)).map(|p| p.dot(direction) + p.dot(up).abs() / tan);
            [wide.dot(direction) + wide.dot(right).abs() / (tan * aspect), high[0], high[1]]
        })
        .fold(0.05, f32::max)
}

/// Returns the box that a portrait shows, given the boxes of hair and head: all hair, and the head down to its chin
/// without the shoulders.
pub fn subject(hair: Bounds, head: Option<Bounds>) -> Bounds {
    let top = head.map_or(hair.1.y, |head| head.1.y.max(hair.1.y));
    let mut lo = hair.0;
    let mut hi = hair.1;
    hi.y = top;
    if let Some(head) = head {
        lo.y = lo.y.min((top - HEAD_HEIGHT).max(head.0.y));
        // A bust's shoulders are wider than the view needs to be; its face is not.
        lo.z = lo.z.min(head.0.z.max(hair.0.z - 0.05));
        hi.z = hi.z.max(head.1.z.min(hair.1.z + 0.05));
    }
    (lo, hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subject_of_short_hair_includes_chin_not_shoulders() {
        let hair = (Vec3::new(-0.09, 1.60, -0.10), Vec3::new(0.09, 1.70, 0.08));
        let bust = (Vec3::new(-0.25, 1.20, -0.15), Vec3::new(0.25, 1.69, 0.12));
        let (lo, hi) = subject(hair, Some(bust));
        assert!((hi.y - lo.y - HEAD_HEIGHT).abs() < 1e-5);
        assert!(hi.x < 0.1 && hi.z >= 0.12);
        assert_eq!(subject(hair, None), hair);
    }

    #[test]
    fn framed_subject_fills_the_image() {
        let subject = (Vec3::new(-0.1, 1.4, -0.1), Vec3::new(0.1, 1.7, 0.1));
        for (direction, size) in
            [(Vec3::Z, [300, 200]), (Vec3::X, [200, 400]), (Vec3::new(0.6, 0.0, 0.8), [300, 200])]
        {
            let camera = Camera::framing(subject, direction, 0.5, size);
            let project = |p: Vec3| (camera.projection * camera.view).project_point3(p);
            let top = project(Vec3::new(0.0, 1.7, 0.0)).y;
            let side = project(Vec3::new(0.0, 1.55, 0.0) + 0.1 * direction.cross(Vec3::Y)).x.abs();
            assert!(top.max(side) > 0.75 && top.max(side) < 0.95, "{top} {side}");
            assert!(project(0.5 * (subject.0 + subject.1)).truncate().length() < 1e-4);
        }
    }

    #[test]
    fn pixel_size_ray_and_depth_match_projection() {
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
