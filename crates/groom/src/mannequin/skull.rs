//! Big forms of the head: the egg of the cranium and the wedge of the face.

use super::forms::*;
use glam::{Vec3, vec3};

/// Half width of the face per 10 mm of height, from 20 mm below the chin upward, mm.
const HALF_WIDTH: [f32; 19] = [
    12.0, 17.5, 24.0, 31.0, 38.0, 44.0, 49.5, 54.0, 57.5, 60.5, 63.0, 64.8, 66.0, 67.0, 67.0, 66.0, 63.0,
    58.0, 50.0,
];
/// Depth of the face in front of the ears at the same heights, mm.
const DEPTH: [f32; 19] = [
    70.0, 78.0, 87.0, 93.0, 94.0, 92.0, 92.5, 93.0, 91.5, 88.5, 85.5, 83.5, 82.5, 82.5, 84.0, 88.5, 87.0,
    82.0, 74.0,
];
const LOWEST: f32 = -20.0;

/// Returns the distance to the cranium. It is widest behind the ears, so it joins two ellipsoids, one for the forehead
/// and one for the occiput.
pub fn cranium(p: Vec3) -> f32 {
    let front = ellipsoid(p, vec3(0.0, 140.0, 10.0), vec3(67.0, 79.0, 82.0));
    let back = ellipsoid(p, vec3(0.0, 137.0, -22.0), vec3(73.0, 81.0, 75.0));
    // The parietal bones widen the top, which would otherwise be egg-shaped.
    join(front, back, 40.0) - 2.8 * hill(p, vec3(42.0, 188.0, -16.0), vec3(60.0, 62.0, 95.0))
}

/// Returns the distance to the face without features: superelliptic sections whose width and depth follow two profiles
/// over the height, closed below by the plane from chin to jaw angle.
pub fn face_wedge(p: Vec3) -> f32 {
    let (w, dw) = curve(&HALF_WIDTH, LOWEST, 10.0, p.y);
    let (front, slope) = curve(&DEPTH, LOWEST, 10.0, p.y);
    let (d, dd) = if p.z > 0.0 { (front, slope) } else { (72.0, 0.0) };
    let q = (p.x.abs() / w, p.z.abs() / d);
    let (sx, sz) = (q.0 * q.0.sqrt(), q.1 * q.1.sqrt());
    let sum = (sx * q.0 + sz * q.1).max(1e-6);
    let f = sum.powf(0.4);
    // Gradient of f, up to the factor sum^-0.6. Its vertical part comes from the slopes of the two profiles.
    let g = vec3(sx / w, (sx * q.0 * dw / w + sz * q.1 * dd / d).abs(), sz / d);
    let sides = (f - 1.0) / (g.length() * f / sum).max(1e-3);
    let bottom_plane = -(p.y + 3.0 - 0.0015 * p.x * p.x) * 0.948 - (p.z - 88.0) * 0.319;
    // The top of the face lies inside the cranium.
    let dome = ellipsoid(p, vec3(0.0, 60.0, -5.0), vec3(95.0, 97.0, 125.0));
    intersect(intersect(sides, bottom_plane, 20.0), dome, 30.0)
}

/// Returns the distance to cranium and face as one form.
pub fn head(p: Vec3) -> f32 {
    join(cranium(p), face_wedge(p), 30.0)
}
