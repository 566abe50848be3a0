//! The region that shadow maps cover.

use crate::Camera;
use glam::Vec3;

/// A sphere, meters: the region that shadow maps cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Center in world space.
    pub center: Vec3,
    /// Radius that encloses everything that casts or receives shadows on hair. Keep it constant while things move, so
    /// that the texels of the shadow maps keep their size.
    pub radius: f32,
}

impl Default for Sphere {
    fn default() -> Self {
        Self { center: Vec3::new(0.0, 1.5, 0.0), radius: 0.3 }
    }
}

impl Sphere {
    /// Returns the sphere around a box.
    pub fn around(lo: Vec3, hi: Vec3) -> Self {
        Self { center: 0.5 * (lo + hi), radius: 0.5 * lo.distance(hi) }
    }

    /// Returns the diameter in pixels of `camera`, measured at the near side of the sphere.
    pub(crate) fn pixels(&self, camera: &Camera) -> f32 {
        let clip = camera.projection * camera.view;
        let away = (clip * self.center.extend(1.0)).w;
        let per_meter = camera.projection.z_axis.w.abs();
        let nearest = if per_meter > 0.0 { (away - self.radius * per_meter).max(0.05) } else { away };
        2.0 * self.radius / (camera.pixel() * nearest)
    }
}
