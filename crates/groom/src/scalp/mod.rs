//! The head that hair grows on: its distance field and landmarks, directions over the scalp, and maps painted on it.

mod map;

pub use map::ScalpMap;

use crate::SdfGrid;
use glam::{Vec2, Vec3};

/// Landmarks of a head for hairstyles, groom space, meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmarks {
    /// Center of the braincase, from which every scalp point is visible.
    pub skull: Vec3,
    /// Point between the eyebrows.
    pub brow: Vec3,
    /// Lowest point of the chin.
    pub chin: Vec3,
    /// Center of the left ear (at positive x); the right one mirrors it.
    pub ear: Vec3,
    /// Lowest point of the hairline at the back of the neck, centered.
    pub nape: Vec3,
}

/// A head on which hair grows.
pub trait Scalp {
    /// Returns the signed distance from the skin, meters, negative inside.
    fn distance(&self, p: Vec3) -> f32;

    /// Returns the landmarks.
    fn landmarks(&self) -> Landmarks;

    /// Returns the outward normal at `p`: the direction of the gradient of the distance.
    fn normal(&self, p: Vec3) -> Vec3 {
        // Four samples at the corners of a tetrahedron give the whole gradient.
        let corners = [
            Vec3::new(1.0, -1.0, -1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, -1.0),
            Vec3::new(1.0, 1.0, 1.0),
        ];
        corners.iter().map(|c| *c * self.distance(p + *c * 8e-4)).sum::<Vec3>().normalize_or(Vec3::Y)
    }

    /// Returns the point of the skin in the direction `dir` from the center of the skull.
    fn point(&self, dir: Vec3) -> Vec3 {
        let from = self.landmarks().skull;
        let dir = dir.normalize_or(Vec3::Y);
        // Sphere tracing from inside: the distance is negative until the skin.
        let mut ray_length = 0.0;
        for _ in 0..60 {
            let distance = self.distance(from + dir * ray_length);
            ray_length -= distance;
            if distance.abs() < 2e-5 {
                break;
            }
        }
        from + dir * ray_length
    }
}

/// A head defined by its distance field on a grid.
#[derive(Clone, Debug)]
pub struct GridScalp {
    /// Distance field.
    pub field: SdfGrid,
    /// Landmarks.
    pub landmarks: Landmarks,
}

impl Scalp for GridScalp {
    fn distance(&self, p: Vec3) -> f32 {
        self.field.sample(p)
    }

    fn landmarks(&self) -> Landmarks {
        self.landmarks
    }
}

/// Returns the direction of the middle of the scalp: up and back.
fn pole() -> Vec3 {
    Vec3::new(0.0, 0.87, -0.493_052_7)
}

/// Angle from the pole at the edge of the scalp map, radians.
const MAP_ANGLE: f32 = 2.4;

/// Returns the position on a scalp map of the direction `dir` from the skull, by azimuthal equidistant projection: the
/// middle of the scalp is at (0.5, 0.5), and the distance from it is proportional to the angle. The left of the head
/// (positive x) is at large u, the front at large v. The whole scalp lies within 0..1.
pub fn scalp_uv(dir: Vec3) -> Vec2 {
    let pole = pole();
    let front = Vec3::X.cross(pole);
    let dir = dir.normalize_or(pole);
    let flat = Vec2::new(dir.x, dir.dot(front));
    let angle = dir.dot(pole).clamp(-1.0, 1.0).acos();
    Vec2::splat(0.5) + flat.normalize_or_zero() * (0.5 * angle / MAP_ANGLE)
}

/// Returns the direction from the skull to the point `uv` of a scalp map. Inverse of [`scalp_uv`].
pub fn scalp_direction(uv: Vec2) -> Vec3 {
    let pole = pole();
    let front = Vec3::X.cross(pole);
    let flat = (uv - Vec2::splat(0.5)) * (2.0 * MAP_ANGLE);
    let (angle, direction) = (flat.length(), flat.normalize_or_zero());
    (pole * angle.cos() + (Vec3::X * direction.x + front * direction.y) * angle.sin()).normalize()
}

/// Returns the stereographic projection of the direction `dir` about the middle of the scalp. It maps circles to
/// circles, so a Delaunay triangulation of the plane is also a Delaunay triangulation of the sphere.
pub(crate) fn stereographic(dir: Vec3) -> Vec2 {
    let pole = pole();
    let front = Vec3::X.cross(pole);
    let dir = dir.normalize_or(pole);
    Vec2::new(dir.x, dir.dot(front)) / (1.0 + dir.dot(pole)).max(1e-3)
}

/// Returns the `i`-th of evenly spread directions over the part of the sphere that holds the scalp. The sequence is an
/// additive recurrence (R2), so every prefix is evenly spread too. `start`, 0 to 1 in each coordinate, shifts it.
pub(crate) fn spread_direction(i: u32, start: Vec2) -> Vec3 {
    let pole = pole();
    let front = Vec3::X.cross(pole);
    // Compute the fractional parts in 64 bits: in 32 bits they would repeat after a million directions.
    let term = |increment: f64, offset: f32| ((f64::from(i) * increment + f64::from(offset)).fract()) as f32;
    let area_fraction = term(0.754_877_666_246_692_8, start.x);
    let azimuth = term(0.569_840_290_998_053_3, start.y) * std::f32::consts::TAU;
    let height = 1.0 - area_fraction * (1.0 - MAP_ANGLE.cos());
    let ring_radius = (1.0 - height * height).max(0.0).sqrt();
    pole * height + (Vec3::X * azimuth.cos() + front * azimuth.sin()) * ring_radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scalp_coordinates_round_trip() {
        for i in 0..500 {
            let dir = spread_direction(i, Vec2::new(0.2, 0.7));
            let uv = scalp_uv(dir);
            assert!(uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all(), "{uv}");
            assert!(scalp_direction(uv).dot(dir) > 0.9999, "{dir}");
        }
        let (left, front) = (scalp_uv(Vec3::X), scalp_uv(Vec3::new(0.0, 0.5, 0.8)));
        assert!(left.x > 0.6 && front.y > 0.6, "{left} {front}");
    }

    #[test]
    fn directions_are_spread_evenly() {
        let count =
            |n: u32| (0..n).filter(|&i| spread_direction(i, Vec2::ZERO).x > 0.3).count() as f32 / n as f32;
        assert!((count(400) - count(20_000)).abs() < 0.02);
    }
}
