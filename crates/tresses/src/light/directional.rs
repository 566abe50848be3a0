//! Directional lights, and those that stand for lights nearby.

use glam::Vec3;

/// Maximum number of directional lights in a scene.
pub const MAX_LIGHTS: usize = crate::constants::MAX_LIGHTS as usize;

/// A light at infinity, with parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Irradiance on a plane that faces the light, linear; 0 switches the light off.
    pub irradiance: Vec3,
}

impl Directional {
    /// No light.
    pub const OFF: Self = Self { direction: Vec3::Y, irradiance: Vec3::ZERO };

    /// Creates the light that a point light at `at` (meters) gives at `target`, the position of the hair. `intensity`
    /// (radiance times square meters) falls off with the squared distance, which is at least 1 cm².
    pub fn from_point(at: Vec3, intensity: Vec3, target: Vec3) -> Self {
        const MIN_DISTANCE_SQUARED: f32 = 1e-4;
        let offset = at - target;
        Self {
            direction: offset.normalize_or(Vec3::Y),
            irradiance: intensity / offset.length_squared().max(MIN_DISTANCE_SQUARED),
        }
    }

    /// Creates the light that a polygonal area light gives at `target`. `corners` (meters) are in order,
    /// counter-clockwise as seen from the front, and the front emits `radiance` in all directions. The direction is the
    /// mean over the polygon. The irradiance is for a surface that faces this direction, with all of the polygon in
    /// front of it (Lambert's formula, 1760). The back emits nothing.
    pub fn from_polygon(corners: &[Vec3], radiance: Vec3, target: Vec3) -> Self {
        let edge = |i: usize| {
            let [a, b] = [i, (i + 1) % corners.len()].map(|i| corners[i] - target);
            let across = a.cross(b);
            // The tangent is accurate for small angles too.
            0.5 * across.length().atan2(a.dot(b)) * across.normalize_or_zero()
        };
        let arrives: Vec3 = (0..corners.len()).map(edge).sum();
        let center = corners.iter().sum::<Vec3>() / corners.len().max(1) as f32 - target;
        // The edges of a counter-clockwise polygon add up to a vector towards `target`. A place in the plane of the
        // polygon gets no light, or NaN.
        let solid_angle = -arrives.length() * arrives.dot(center).signum();
        if !(solid_angle > 1e-6 && solid_angle.is_finite()) {
            return Self::OFF;
        }
        Self { direction: -arrives.normalize_or(Vec3::Y), irradiance: solid_angle * radiance }
    }

    /// Whether the light emits anything.
    pub fn is_on(&self) -> bool {
        self.irradiance.max_element() > 0.0
    }
}
