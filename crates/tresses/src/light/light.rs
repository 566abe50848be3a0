//! A light of a scene: its shape, its strength, and what arrives of it at a point.

use crate::{Error, Result};
use glam::Vec3;

/// Place and shape of a [`Light`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightShape {
    /// A light at infinity, with parallel rays.
    Distant {
        /// Direction towards the light.
        direction: Vec3,
    },
    /// A point that emits in all directions.
    Point {
        /// Position, meters.
        position: Vec3,
    },
    /// A point that emits into a cone. The light falls from the inner to the outer angle, as in `KHR_lights_punctual`.
    Spot {
        /// Position, meters.
        position: Vec3,
        /// Direction into which it shines.
        direction: Vec3,
        /// Angle between the axis and the edge of full light, radians.
        inner: f32,
        /// Angle between the axis and the end of the cone, radians; less than π/2.
        outer: f32,
    },
    /// A rectangle that emits from the side of `right` × `up`.
    Rectangle {
        /// Center, meters.
        center: Vec3,
        /// Half of the horizontal edge: from the center to the right edge as seen from the front, meters.
        right: Vec3,
        /// Half of the vertical edge: from the center to the upper edge, meters.
        up: Vec3,
    },
    /// A disc or a ring that emits from one side.
    Disc {
        /// Center, meters.
        center: Vec3,
        /// Direction into which it shines.
        direction: Vec3,
        /// Radius, meters.
        radius: f32,
        /// Radius of the hole in a ring, meters; 0 for a disc.
        hole: f32,
    },
    /// A sphere.
    Sphere {
        /// Center, meters.
        center: Vec3,
        /// Radius, meters.
        radius: f32,
    },
    /// A cylinder without caps, such as a neon tube.
    Tube {
        /// Both ends of the axis, meters.
        ends: [Vec3; 2],
        /// Radius, meters.
        radius: f32,
    },
}

/// A light of a scene. Units are those of glTF's `KHR_lights_punctual`, or any other unit that all lights share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Place and shape.
    pub shape: LightShape,
    /// Color, linear.
    pub color: Vec3,
    /// Strength, by which the color is multiplied: irradiance of a distant light (lux), luminous intensity of a point
    /// or spot light (candela), radiance of all others (candela per square meter). 0 is off.
    pub intensity: f32,
    /// Distance at which the light ends, meters; infinite by default, and without meaning for distant lights. The light
    /// is multiplied by (1 - (distance / range)⁴)² (Karis 2013).
    pub range: f32,
    /// Whether its shadows fall on meshes and on the host's scene. Hair always lies in the shadow of hair and bodies.
    pub casts_shadows: bool,
    /// The host's name for the light, in [`SceneShadow::light`](super::SceneShadow::light) and in the shaders of a
    /// scene. Of several lights with one name, the first counts.
    pub id: u32,
}

/// Minimum distance to a light, meters. Light does not grow without bound.
const MIN_DISTANCE: f32 = 0.01;
/// Corners of the polygon that stands for a circle.
const CIRCLE_CORNERS: u32 = 16;

impl Light {
    /// Creates a light of `shape`, with a white color.
    pub fn new(shape: LightShape, intensity: f32) -> Self {
        Self { shape, color: Vec3::ONE, intensity, range: f32::INFINITY, casts_shadows: true, id: 0 }
    }

    /// Creates a distant light. `direction` leads towards it; `irradiance` is that of a surface which faces it.
    pub fn distant(direction: Vec3, irradiance: Vec3) -> Self {
        Self { color: irradiance, ..Self::new(LightShape::Distant { direction }, 1.0) }
    }

    /// Creates a point light at `position` (meters) with `intensity` (candela).
    pub fn point(position: Vec3, intensity: Vec3) -> Self {
        Self { color: intensity, ..Self::new(LightShape::Point { position }, 1.0) }
    }

    /// Creates an area light of `shape` with `radiance`.
    pub fn area(shape: LightShape, radiance: Vec3) -> Self {
        Self { color: radiance, ..Self::new(shape, 1.0) }
    }

    /// Returns the light with an `id`.
    pub fn with_id(self, id: u32) -> Self {
        Self { id, ..self }
    }

    /// Color times intensity.
    pub fn strength(&self) -> Vec3 {
        self.color * self.intensity
    }

    /// Whether the light emits anything.
    pub fn is_on(&self) -> bool {
        self.strength().max_element() > 0.0
    }

    /// Returns the mean direction towards the light at `position` (meters), and the irradiance of a surface that faces
    /// it. For area lights this is Lambert's formula (1760).
    pub fn irradiance_at(&self, position: Vec3) -> (Vec3, Vec3) {
        let (direction, per_strength) = match self.shape {
            LightShape::Distant { direction } => (direction.normalize_or(Vec3::Y), 1.0),
            LightShape::Point { position: light } => from_point(light - position),
            LightShape::Spot { position: light, direction, inner, outer } => {
                let (towards, irradiance) = from_point(light - position);
                let [scale, offset] = cone(inner, outer);
                let inside = (offset - scale * direction.normalize_or_zero().dot(towards)).clamp(0.0, 1.0);
                (towards, irradiance * inside * inside)
            }
            LightShape::Rectangle { center, right, up } => {
                let corners = [right + up, up - right, -right - up, right - up];
                from_polygon(center - position, right.cross(up), &corners)
            }
            LightShape::Disc { center, direction, radius, hole } => {
                from_disc(center - position, direction, [radius, hole])
            }
            LightShape::Sphere { center, radius } => {
                let offset = center - position;
                let square = offset.length_squared().max(radius * radius).max(MIN_DISTANCE * MIN_DISTANCE);
                (offset.normalize_or(Vec3::Y), std::f32::consts::PI * radius * radius / square)
            }
            LightShape::Tube { ends, radius } => from_tube(ends.map(|end| end - position), radius),
        };
        (direction, self.strength() * (per_strength * self.window(position)))
    }

    /// Center of the light, meters; `None` for a distant one.
    pub fn center(&self) -> Option<Vec3> {
        match self.shape {
            LightShape::Distant { .. } => None,
            LightShape::Point { position } | LightShape::Spot { position, .. } => Some(position),
            LightShape::Rectangle { center, .. }
            | LightShape::Disc { center, .. }
            | LightShape::Sphere { center, .. } => Some(center),
            LightShape::Tube { ends: [a, b], .. } => Some(0.5 * (a + b)),
        }
    }

    /// Fraction of the light that its range leaves at `position`.
    fn window(&self, position: Vec3) -> f32 {
        let Some(center) = self.center().filter(|_| self.range.is_finite()) else { return 1.0 };
        let spent = position.distance_squared(center) / (self.range * self.range);
        let left = (1.0 - spent * spent).clamp(0.0, 1.0);
        left * left
    }

    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Parameter`] when a number is not finite, a strength or size is negative, or a cone is not one.
    pub fn check(&self) -> Result<()> {
        let all = |values: &[f32], name, range| match values
            .iter()
            .find(|value| !(value.is_finite() && **value >= 0.0))
        {
            Some(value) => Err(Error::Parameter { name, value: value.to_string(), range }),
            None => Ok(()),
        };
        let finite = |vectors: &[Vec3]| match vectors.iter().find(|vector| !vector.is_finite()) {
            Some(vector) => Err(Error::Parameter {
                name: "the place or direction of a light",
                value: vector.to_string(),
                range: "finite",
            }),
            None => Ok(()),
        };
        let sizes = |values: &[f32]| all(values, "the size of a light", "a finite length, 0 or more");
        all(&self.color.to_array(), "the color of a light", "finite, 0 or more")?;
        all(&[self.intensity], "the intensity of a light", "finite, 0 or more")?;
        all(&self.strength().to_array(), "color times intensity of a light", "finite")?;
        if self.range.is_nan() || self.range <= 0.0 {
            let value = self.range.to_string();
            return Err(Error::Parameter {
                name: "the range of a light",
                value,
                range: "more than 0 meters",
            });
        }
        match self.shape {
            LightShape::Distant { direction } => finite(&[direction]),
            LightShape::Point { position } => finite(&[position]),
            LightShape::Spot { position, direction, inner, outer } => {
                finite(&[position, direction])?;
                let is_cone = 0.0 <= inner && inner <= outer && outer <= std::f32::consts::FRAC_PI_2;
                let value = || format!("{inner} to {outer} radians");
                let range = "between 0 and π/2, the inner no wider than the outer";
                is_cone.then_some(()).ok_or_else(|| Error::Parameter {
                    name: "the cone of a light",
                    value: value(),
                    range,
                })
            }
            LightShape::Rectangle { center, right, up } => finite(&[center, right, up]),
            LightShape::Disc { center, direction, radius, hole } => {
                finite(&[center, direction])?;
                sizes(&[radius, hole])
            }
            LightShape::Sphere { center, radius } => {
                finite(&[center])?;
                sizes(&[radius])
            }
            LightShape::Tube { ends, radius } => {
                finite(&ends)?;
                sizes(&[radius])
            }
        }
    }
}

/// Returns the direction to a point at `offset`, and its irradiance per intensity.
fn from_point(offset: Vec3) -> (Vec3, f32) {
    let square = offset.length_squared().max(MIN_DISTANCE * MIN_DISTANCE);
    (offset.normalize_or(Vec3::Y), 1.0 / square)
}

/// Returns scale and offset of a spot light's falloff, which is (offset + scale · cosine)², clamped
/// (`KHR_lights_punctual`).
pub(super) fn cone(inner: f32, outer: f32) -> [f32; 2] {
    let scale = 1.0 / (inner.cos() - outer.cos()).max(1e-4);
    [scale, -outer.cos() * scale]
}

/// Returns the direction to a polygon around `center`, and its irradiance per radiance. `corners` are relative to the
/// center, counterclockwise as seen from the side of `normal`.
fn from_polygon(center: Vec3, normal: Vec3, corners: &[Vec3]) -> (Vec3, f32) {
    // There is no light behind the polygon.
    if center.dot(normal) >= 0.0 {
        return (center.normalize_or(Vec3::Y), 0.0);
    }
    let edge = |i: usize| {
        let [a, b] = [i, (i + 1) % corners.len()].map(|i| center + corners[i]);
        let across = a.cross(b);
        // The tangent is accurate for small angles too.
        -0.5 * across.length().atan2(a.dot(b)) * across.normalize_or_zero()
    };
    let arrives: Vec3 = (0..corners.len()).map(edge).sum();
    (arrives.normalize_or(center.normalize_or(Vec3::Y)), arrives.length())
}

/// Returns the direction to a ring, and its irradiance per radiance.
fn from_disc(center: Vec3, normal: Vec3, [radius, hole]: [f32; 2]) -> (Vec3, f32) {
    let normal = normal.normalize_or(Vec3::Y);
    let right = normal.any_orthonormal_vector();
    let up = normal.cross(right);
    // A polygon with the area of the circle.
    let step = std::f32::consts::TAU / CIRCLE_CORNERS as f32;
    let wide = (step / step.sin()).sqrt();
    let circle = |radius: f32| {
        let corners: [Vec3; CIRCLE_CORNERS as usize] = std::array::from_fn(|i| {
            let (sin, cos) = (i as f32 * step).sin_cos();
            wide * radius * (cos * right + sin * up)
        });
        let (direction, irradiance) = from_polygon(center, normal, &corners);
        direction * irradiance
    };
    let arrives = circle(radius) - circle(hole.min(radius));
    (arrives.normalize_or(center.normalize_or(Vec3::Y)), arrives.length())
}

/// Returns the direction to a cylinder with these `ends`, and its irradiance per radiance: that of a strip which faces
/// the point everywhere, as wide as the cylinder.
fn from_tube([a, b]: [Vec3; 2], radius: f32) -> (Vec3, f32) {
    let axis = (b - a).normalize_or_zero();
    let middle = 0.5 * (a + b);
    if axis == Vec3::ZERO {
        return (middle.normalize_or(Vec3::Y), 0.0);
    }
    let nearest = a - axis * a.dot(axis);
    let height = nearest.length().max(radius).max(MIN_DISTANCE);
    let normal = nearest.normalize_or(axis.any_orthonormal_vector());
    // Angles of the ends from the perpendicular. The strip's solid angle is that of an arc of cosines.
    let [from, to] = [a, b].map(|end| end.dot(axis).atan2(height));
    let towards = 0.5 * (to - from + 0.5 * ((2.0 * to).sin() - (2.0 * from).sin()));
    let along = 0.5 * (to.sin() * to.sin() - from.sin() * from.sin());
    let arrives = (2.0 * radius / height) * (normal * towards + axis * along);
    (arrives.normalize_or(normal), arrives.length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    fn irradiance(light: &Light, position: Vec3) -> (Vec3, f32) {
        let (direction, irradiance) = light.irradiance_at(position);
        (direction, irradiance.x)
    }

    fn near(found: f32, expected: f32) -> bool {
        (found / expected - 1.0).abs() < 2e-3
    }

    #[test]
    fn point_light_falls_off_and_ends_at_its_range() {
        let point = Light::point(Vec3::Y * 3.0, Vec3::splat(18.0));
        assert_eq!(irradiance(&point, Vec3::Y), (Vec3::Y, 4.5));
        // One centimeter is the least distance.
        assert_eq!(irradiance(&point, Vec3::Y * 3.0).1, 18.0 / 1e-4);
        let short = Light { range: 4.0, ..point };
        assert_eq!(irradiance(&short, Vec3::NEG_Y).1, 0.0);
        let left = 1.0 - 0.5_f32.powi(4);
        assert!(near(irradiance(&short, Vec3::Y).1, 4.5 * left * left));
    }

    #[test]
    fn spot_light_is_limited_to_its_cone() {
        let shape = LightShape::Spot { position: Vec3::Y, direction: Vec3::NEG_Y, inner: 0.2, outer: 0.4 };
        let spot = Light::new(shape, 100.0);
        let at = |angle: f32| irradiance(&spot, Vec3::new(angle.sin(), 1.0 - angle.cos(), 0.0)).1;
        assert!(near(at(0.0), 100.0) && near(at(0.19), 100.0), "{} {}", at(0.0), at(0.19));
        assert!(at(0.3) > 5.0 && at(0.3) < 60.0, "{}", at(0.3));
        assert_eq!(at(0.41), 0.0);
        assert_eq!(irradiance(&spot, Vec3::Y * 2.0).1, 0.0, "behind it");
    }

    #[test]
    fn area_lights_match_closed_forms() {
        // Above the place, facing down.
        let square = |half: f32| {
            let shape =
                LightShape::Rectangle { center: Vec3::Y * 2.0, right: Vec3::X * half, up: Vec3::Z * half };
            Light::new(shape, 1.0)
        };
        // A small square is a point light of its area times the cosine; an infinite plane gives as much as a sky.
        let (direction, below) = irradiance(&square(0.01), Vec3::ZERO);
        assert!(direction.dot(Vec3::Y) > 0.999 && near(below, 4e-4 / 4.0), "{direction} {below}");
        let (_, aside) = irradiance(&square(0.01), Vec3::X * 2.0);
        assert!(near(aside, 4e-4 / 8.0 * 0.5_f32.sqrt()), "{aside}");
        assert!(near(irradiance(&square(1e4), Vec3::ZERO).1, PI));
        assert_eq!(irradiance(&square(1.0), Vec3::Y * 3.0).1, 0.0, "it emits on one side");
        assert_eq!(irradiance(&square(1.0), Vec3::new(5.0, 2.0, 0.0)).1, 0.0, "nothing leaves in its plane");
        // A disc above the place: π r² / (r² + d²). A ring is a disc less its hole.
        let disc = |radius, hole| {
            let shape = LightShape::Disc { center: Vec3::Y * 2.0, direction: Vec3::NEG_Y, radius, hole };
            irradiance(&Light::new(shape, 1.0), Vec3::ZERO).1
        };
        let expected = |radius: f32| PI * radius * radius / (radius * radius + 4.0);
        assert!((disc(1.5, 0.0) / expected(1.5) - 1.0).abs() < 0.01, "{} {}", disc(1.5, 0.0), expected(1.5));
        assert!((disc(1.5, 1.0) / (expected(1.5) - expected(1.0)) - 1.0).abs() < 0.02, "{}", disc(1.5, 1.0));
        let ball = Light::new(LightShape::Sphere { center: Vec3::Y * 2.0, radius: 0.5 }, 1.0);
        assert!(near(irradiance(&ball, Vec3::ZERO).1, PI / 16.0));
        // An infinite tube: 2 r / h times the integral of the squared cosine, π / 2. A short one is a point.
        let tube = |half: f32| {
            let ends = [Vec3::new(-half, 2.0, 0.0), Vec3::new(half, 2.0, 0.0)];
            irradiance(&Light::new(LightShape::Tube { ends, radius: 0.01 }, 1.0), Vec3::ZERO)
        };
        assert!(near(tube(1e4).1, 0.01 * PI / 2.0), "{:?}", tube(1e4));
        assert!(near(tube(0.01).1, 4e-4 / 4.0) && tube(0.01).0.dot(Vec3::Y) > 0.999, "{:?}", tube(0.01));
    }

    #[test]
    fn invalid_lights_are_errors() {
        let usual = Light::point(Vec3::Y, Vec3::ONE);
        assert!(usual.check().is_ok() && usual.is_on());
        let off = Light { intensity: 0.0, ..usual };
        assert!(off.check().is_ok() && !off.is_on());
        let spot = |inner, outer| {
            Light::new(LightShape::Spot { position: Vec3::Y, direction: Vec3::X, inner, outer }, 1.0)
        };
        assert!(spot(0.2, 0.4).check().is_ok());
        let invalid = [
            Light { intensity: -1.0, ..usual },
            Light { intensity: f32::NAN, ..usual },
            Light { color: Vec3::new(0.0, f32::INFINITY, 0.0), ..usual },
            Light { range: -2.0, ..usual },
            Light { range: f32::NAN, ..usual },
            Light::point(Vec3::NAN, Vec3::ONE),
            Light::distant(Vec3::NAN, Vec3::ONE),
            Light::new(LightShape::Sphere { center: Vec3::ZERO, radius: -0.1 }, 1.0),
            spot(0.5, 0.4),
            spot(0.5, 3.0),
        ];
        for light in invalid {
            let error = light.check().unwrap_err().to_string();
            assert!(error.contains("of a light is"), "{error}");
        }
    }
}
