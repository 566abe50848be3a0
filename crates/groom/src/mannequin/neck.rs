//! Neck, leaning forward from the shoulders, with a hint of the sternomastoid.

use super::forms::*;
use glam::{Vec3, vec3};

/// Returns the signed distance to the neck, mm; `p.x` must not be negative.
pub fn neck(p: Vec3) -> f32 {
    // Two strokes, one behind the other, make a section a little deeper than wide.
    let front = stroke(p, vec3(0.0, 60.0, -8.0), 36.8, vec3(0.0, -120.0, -47.0), 40.5);
    let back = stroke(p, vec3(0.0, 70.0, -33.0), 38.8, vec3(0.0, -120.0, -67.0), 42.5);
    let body = join(front, back, 30.0);
    let q = vec3(astride(p.x, 6.0), p.y, p.z);
    let mastoid = stroke(q, vec3(35.0, 60.0, -26.0), 7.8, vec3(5.0, -98.0, 2.0), 4.0);
    let throat = stroke(p, vec3(0.0, 15.0, 27.0), 9.8, vec3(0.0, -90.0, -8.0), 10.0);
    join(join(body, mastoid, 20.0), throat, 22.0)
}
