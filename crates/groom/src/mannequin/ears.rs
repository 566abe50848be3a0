//! Ears: a shell hollowed from an ellipsoid, so that its edge is the rim, with fold, bowl, tragus and lobe.

use super::forms::*;
use glam::{Vec2, Vec3, vec2, vec3};

/// Center of the ear where it joins the head, mm.
const CENTER: Vec3 = vec3(74.0, 90.0, -9.0);
/// Backward tilt of the ear, radians.
const LEAN: f32 = 0.22;
/// Directions backward along the ear and out of its bowl. The ear stands off the head by 27°.
const BACK: Vec3 = vec3(0.454, 0.0, -0.891);
const OUT: Vec3 = vec3(0.891, 0.0, 0.454);

/// Returns the signed distance to the ear, mm; `p.x` must not be negative.
pub fn ear(p: Vec3) -> f32 {
    let q = p - CENTER;
    let bound = q.length() - 36.0;
    if bound > 12.0 {
        return bound;
    }
    let flat = Vec2::from_angle(LEAN).rotate(vec2(q.dot(BACK), q.y));
    let q = vec3(flat.x, flat.y, q.dot(OUT));
    let egg = ellipsoid(q, vec3(0.5, 4.0, 0.0), vec3(16.5, 26.5, 6.5));
    let lobe = ellipsoid(q, vec3(-4.0, -19.0, 0.5), vec3(8.0, 11.0, 4.2));
    let hollow = ellipsoid(q, vec3(-0.5, 6.0, 7.0), vec3(12.0, 21.0, 7.6));
    let fold = join(
        stroke(q, vec3(2.0, 15.0, -2.5), 2.4, vec3(4.5, -1.0, -1.0), 2.8),
        stroke(q, vec3(4.5, -1.0, -1.0), 2.8, vec3(0.0, -14.0, 0.5), 3.2),
        4.0,
    );
    let bowl = ellipsoid(q, vec3(-4.0, -3.0, 4.5), vec3(6.0, 9.0, 6.5));
    let tragus = ellipsoid(q, vec3(-11.0, -5.5, 1.5), vec3(4.0, 6.5, 4.5));
    let root = ellipsoid(q, vec3(-3.0, 0.0, -9.0), vec3(12.0, 22.0, 10.0));
    let d = carve(join(egg, lobe, 8.0), hollow, 4.0);
    let d = carve(join(d, fold, 7.0), bowl, 5.0);
    join(join(d, tragus, 4.0), root, 6.0)
}
