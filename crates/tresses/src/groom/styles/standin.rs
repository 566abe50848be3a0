//! A plain head for tests: a braincase, a face, ears, a neck and shoulders from a few solids.

use super::scalp::{GridScalp, Landmarks};
use crate::groom::SdfGrid;
use glam::Vec3;

fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> f32 {
    let k0 = ((p - centre) / radii).length();
    let k1 = ((p - centre) / (radii * radii)).length();
    k0 * (k0 - 1.0) / k1.max(1e-6)
}

fn capsule(p: Vec3, a: Vec3, b: Vec3, radius: f32) -> f32 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t) - radius
}

fn union(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k * 0.25
}

/// The signed distance of the plain head, metres; its chin is 22 cm below its crown.
pub fn distance(p: Vec3) -> f32 {
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let skull = ellipsoid(p, Vec3::new(0.0, 0.03, -0.012), Vec3::new(0.075, 0.08, 0.095));
    let face = ellipsoid(p, Vec3::new(0.0, -0.025, 0.025), Vec3::new(0.058, 0.085, 0.066));
    let nose = capsule(p, Vec3::new(0.0, 0.01, 0.088), Vec3::new(0.0, -0.045, 0.103), 0.009);
    let ear = ellipsoid(q, Vec3::new(0.077, -0.015, -0.012), Vec3::new(0.011, 0.032, 0.019));
    let neck = capsule(p, Vec3::new(0.0, -0.05, -0.03), Vec3::new(0.0, -0.22, -0.055), 0.053);
    let shoulders = capsule(p, Vec3::new(-0.15, -0.25, -0.055), Vec3::new(0.15, -0.25, -0.055), 0.055);
    let head = union(union(skull, face, 0.03), nose, 0.015);
    union(union(union(head, neck, 0.03), shoulders, 0.06), ear, 0.006)
}

/// The plain head on a grid.
pub fn head() -> GridScalp {
    let field = SdfGrid::from_fn(Vec3::new(-0.2, -0.3, -0.2), Vec3::new(0.2, 0.2, 0.2), 128, distance);
    let landmarks = Landmarks {
        skull: Vec3::new(0.0, 0.03, -0.012),
        brow: Vec3::new(0.0, 0.015, 0.09),
        chin: Vec3::new(0.0, -0.11, 0.03),
        ear: Vec3::new(0.08, -0.015, -0.012),
        nape: Vec3::new(0.0, -0.065, -0.085),
    };
    GridScalp { field, landmarks }
}
