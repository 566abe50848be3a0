//! Facial hair: brows, lashes and beards, grown on the sculpture.
//!
//! Facial hair follows landmarks of the skin, not maps over a scalp: brows lie on their ridge, lashes where the lids
//! meet, a beard below a line from the ears over the cheeks to the mouth. Each kind therefore has its own rules. No
//! guides are draped, because hair of some millimeters keeps the direction of its growth. The strands are bound to
//! guides among them like the strands of a file ([`crate::bind()`]).
//!
//! The unit in this module is the millimeter, as in the rest of the sculpture. Every function is deterministic. The two
//! sides of the face differ slightly, as in a real face.

mod beard;
mod brows;
mod lashes;
#[cfg(test)]
mod tests;

pub use beard::{Beard, beard};
pub use brows::brows;
pub use lashes::lashes;

use super::distance;
use crate::Strands;
use glam::{Vec3, vec3};

/// Minimum distance of a strand's axis from the skin, mm.
const CLEARANCE: f32 = 0.12;
/// Depth of a strand's root below the skin, mm.
const DEPTH: f32 = 0.15;

/// Returns the signed distance from `p` to the skin, mm, negative inside.
fn skin(p: Vec3) -> f32 {
    distance(p * 0.001) * 1000.0
}

/// Returns the outward normal of the skin at `p`.
fn normal(p: Vec3) -> Vec3 {
    const H: f32 = 0.15;
    let along = |e: Vec3| skin(p + e * H) - skin(p - e * H);
    vec3(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)).normalize_or(Vec3::Z)
}

/// Returns the point of the skin at `x` and `y` (mm) that is visible from the front.
fn in_front(x: f32, y: f32) -> Vec3 {
    let mut p = vec3(x, y, 135.0);
    for _ in 0..60 {
        let gap = skin(p);
        if gap < 0.01 {
            break;
        }
        // Distances can be too short in the creases, but are never much too long.
        p.z -= 0.8 * gap;
    }
    p
}

/// Grows a strand of `count` vertices and `length` mm from `root` at the skin. `direction` returns the direction of a
/// step from the fraction of the length and the outward normal at the root. Steps into the skin are pushed out.
fn grow(root: Vec3, length: f32, count: usize, direction: impl Fn(f32, Vec3) -> Vec3) -> Vec<Vec3> {
    let out = normal(root);
    let step = length / (count - 1) as f32;
    // A point on a mesh can be slightly off the skin, and distances are short in creases, so iterate.
    let mut p = root;
    for _ in 0..3 {
        p -= out * (skin(p) + DEPTH);
    }
    let mut line = Vec::with_capacity(count);
    line.push(p);
    for i in 1..count {
        let t = (i as f32 - 0.5) / (count - 1) as f32;
        let mut next = p + direction(t, out).normalize_or(out) * step;
        let depth = CLEARANCE - skin(next);
        if depth > 0.0 {
            next += normal(next) * depth;
            // Keep the length of the step along the skin.
            next = p + (next - p).normalize_or(out) * step;
        }
        p = next;
        line.push(p);
    }
    line
}

/// Adds a strand (mm) that is `width` mm wide at its root and tapers toward its tip.
fn push(into: &mut Strands, line: &[Vec3], width: f32, tip: f32) {
    let line: Vec<_> = line.iter().map(|p| *p * 0.001).collect();
    into.push(&line);
    let last = (line.len() - 1) as f32;
    into.radii.extend((0..line.len()).map(|i| {
        let t = i as f32 / last;
        0.0005 * width * (1.0 + (tip - 1.0) * t * t)
    }));
}
