//! Table of shapes, and distances in a shape's own frame: the CPU versions of `shape.wesl`.

use super::{Collider, Shape};
use crate::{Error, Result, constants::MAX_COLLIDERS};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
#[cfg(test)]
use glam::Vec4;

/// `ShapeData::kind` of a capsule.
pub const CAPSULE: u32 = 0;
/// `ShapeData::kind` of an ellipsoid.
pub const ELLIPSOID: u32 = 1;
/// `ShapeData::kind` of a distance field.
pub const FIELD: u32 = 2;

/// A shape in GPU layout.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct ShapeData {
    /// Center of the bounding sphere in the shape's frame, meters.
    pub center: Vec3,
    /// Radius of the bounding sphere, meters.
    pub bound: f32,
    /// Size, meters. Capsule: radius, half length, 0. Ellipsoid: half axes. Field: half edges of the box around
    /// `center` that contains everything solid.
    pub size: Vec3,
    /// [`CAPSULE`], [`ELLIPSOID`] or [`FIELD`].
    pub kind: u32,
    /// Field: texture coordinate of the origin of its frame.
    pub bias: Vec3,
    /// Factor of the friction coefficient.
    pub friction: f32,
    /// Field: texture coordinates per meter.
    pub scale: Vec3,
    /// Field: its index among the [deforming](super::deform) fields plus one; 0 for a rigid field.
    pub deforms: u32,
    /// Field: smallest texture coordinate that samples only its own tile.
    pub low: Vec3,
    /// Unused.
    pub _pad_b: f32,
    /// Field: largest texture coordinate that samples only its own tile.
    pub high: Vec3,
    /// Unused.
    pub _pad_c: f32,
}

/// Uniform with all shapes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ShapeTable {
    /// The shapes; [`PoseHead`](super::PoseHead) has their number.
    pub list: [ShapeData; MAX_COLLIDERS as usize],
}

impl ShapeData {
    /// Converts a collider. The atlas coordinates of a field remain unset.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a size is not positive or a coefficient is negative.
    pub fn new(collider: &Collider) -> Result<Self> {
        let positive = |name, v: f32| match v > 0.0 && v < 1e3 {
            true => Ok(()),
            false => Err(Error::Parameter { name, value: v.to_string(), range: "positive and below 1 km" }),
        };
        if !(0.0..=100.0).contains(&collider.friction) {
            return Err(Error::Parameter {
                name: "a collider's friction",
                value: collider.friction.to_string(),
                range: "from 0 to 100",
            });
        }
        let base = Self { friction: collider.friction, ..Self::zeroed() };
        Ok(match collider.shape {
            Shape::Capsule { half_length, radius } => {
                positive("a capsule's radius", radius)?;
                if half_length != 0.0 {
                    positive("a capsule's half length", half_length)?;
                }
                let size = Vec3::new(radius, half_length, 0.0);
                Self { kind: CAPSULE, size, bound: radius + half_length, ..base }
            }
            Shape::Ellipsoid { radii } => {
                positive("an ellipsoid's half axis", radii.min_element())?;
                positive("an ellipsoid's half axis", radii.max_element())?;
                Self { kind: ELLIPSOID, size: radii, bound: radii.max_element(), ..base }
            }
            Shape::Field(_) => Self { kind: FIELD, ..base },
        })
    }
}

/// Returns unit normal (xyz) and distance (w, meters) of a capsule at `p` in its frame.
#[cfg(test)]
pub fn capsule(p: Vec3, radius: f32, half_length: f32) -> Vec4 {
    let offset = p - Vec3::Y * p.y.clamp(-half_length, half_length);
    let far = offset.length();
    let n = if far > 1e-9 { offset / far } else { Vec3::X };
    n.extend(far - radius)
}

/// Returns unit normal (xyz) and distance (w, meters, to first order) of an ellipsoid at `p` in its frame.
#[cfg(test)]
pub fn ellipsoid(p: Vec3, radii: Vec3) -> Vec4 {
    let a = p / radii;
    let b = a / radii;
    let (k1, k2) = (a.length(), b.length());
    if k2 < 1e-9 {
        return Vec3::Y.extend(-radii.min_element());
    }
    (b / k2).extend(k1 * (k1 - 1.0) / k2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ellipsoid_is_exact_to_first_order_at_surface() {
        let radii = Vec3::new(0.05, 0.08, 0.12);
        for i in 0..200 {
            let a = i as f32 * 2.399_963;
            let z = 1.0 - (i as f32 + 0.5) / 100.0;
            let r = (1.0 - z * z).sqrt();
            let on = Vec3::new(r * a.cos(), r * a.sin(), z) * radii;
            let at = ellipsoid(on, radii);
            assert!(at.w.abs() < 1e-7);
            let off = |d: f32| (ellipsoid(on + at.truncate() * d, radii).w - d).abs();
            // The error falls with the square of the distance.
            assert!(off(1e-3) < 2e-5 && off(1e-4) < 1e-6, "{} {}", off(1e-3), off(1e-4));
            // The test would detect a wrong normal.
            let radial = on.normalize();
            let wrong = (ellipsoid(on + radial * 5e-3, radii).w - 5e-3).abs();
            assert!(at.truncate().dot(radial) > 0.99 || wrong > 4e-5, "{wrong}");
        }
        assert!(ellipsoid(Vec3::ZERO, radii).w < -0.049);
        assert!(ellipsoid(Vec3::splat(1e-4), radii).w < -0.04);
    }

    #[test]
    fn capsule_matches_closed_form() {
        let at = capsule(Vec3::new(0.0, 0.3, 0.1), 0.04, 0.2);
        assert!((at.w - (0.02f32.sqrt() - 0.04)).abs() < 1e-6);
        assert!((at.truncate() - Vec3::new(0.0, 0.1, 0.1).normalize()).length() < 1e-6);
        assert_eq!(capsule(Vec3::ZERO, 0.04, 0.2).w, -0.04);
    }

    #[test]
    fn invalid_shapes_return_errors() {
        let bad = |shape, friction| ShapeData::new(&Collider { friction, ..Collider::new(shape) }).is_err();
        assert!(bad(Shape::sphere(0.0), 1.0));
        assert!(bad(Shape::sphere(f32::NAN), 1.0));
        assert!(bad(Shape::Capsule { half_length: -1.0, radius: 0.1 }, 1.0));
        assert!(bad(Shape::Ellipsoid { radii: Vec3::new(0.1, 0.0, 0.1) }, 1.0));
        assert!(bad(Shape::sphere(0.1), -1.0));
        assert!(!bad(Shape::sphere(0.1), 0.0));
    }
}
