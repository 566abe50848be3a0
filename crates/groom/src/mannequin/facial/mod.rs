//! The hair of the face: brows, lashes and beards, grown on the sculpture itself.
//!
//! Hair of the face lies where its skin has landmarks, not where a scalp's maps say: brows on their ridge, lashes where
//! the lids meet, a beard below a line from the ears over the cheeks to the mouth. So each is grown by its own rules, and
//! no guides are draped: what is millimetres long stands as it grows. Strands are bound to guides among them as those of a
//! file are ([`crate::bind()`]).
//!
//! As in the rest of the sculpture the unit inside is the millimetre. Every function is the same on each run; the two
//! sides of the face differ as those of a person do.

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

/// How far the axis of a strand stays from the skin, mm.
const CLEARANCE: f32 = 0.12;
/// How deep below the skin a strand begins, mm.
const DEPTH: f32 = 0.15;

/// The distance from `p` to the skin, mm, negative inside.
fn skin(p: Vec3) -> f32 {
    distance(p * 0.001) * 1000.0
}

/// The way out of the skin at `p`.
fn normal(p: Vec3) -> Vec3 {
    const H: f32 = 0.15;
    let along = |e: Vec3| skin(p + e * H) - skin(p - e * H);
    vec3(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)).normalize_or(Vec3::Z)
}

/// The point of the skin that one sees from in front at `x` and `y`, mm.
fn in_front(x: f32, y: f32) -> Vec3 {
    let mut p = vec3(x, y, 135.0);
    for _ in 0..60 {
        let gap = skin(p);
        if gap < 0.01 {
            break;
        }
        // Distances may be short in the creases, and never far too long.
        p.z -= 0.8 * gap;
    }
    p
}

/// A strand of `count` vertices from `root` at the skin, `length` mm long: at each step it goes where `way` says (what part
/// of the length is done, the way out of the skin at the root), and never into the skin.
fn grow(root: Vec3, length: f32, count: usize, way: impl Fn(f32, Vec3) -> Vec3) -> Vec<Vec3> {
    let out = normal(root);
    let step = length / (count - 1) as f32;
    // A place on a mesh may be a little beside the skin, and distances are short in creases.
    let mut p = root;
    for _ in 0..3 {
        p -= out * (skin(p) + DEPTH);
    }
    let mut line = Vec::with_capacity(count);
    line.push(p);
    for i in 1..count {
        let t = (i as f32 - 0.5) / (count - 1) as f32;
        let mut next = p + way(t, out).normalize_or(out) * step;
        let depth = CLEARANCE - skin(next);
        if depth > 0.0 {
            next += normal(next) * depth;
            // As long as it was, along the skin.
            next = p + (next - p).normalize_or(out) * step;
        }
        p = next;
        line.push(p);
    }
    line
}

/// Adds a strand, mm, that is `width` mm wide at its root and thins out towards its tip.
fn push(into: &mut Strands, line: &[Vec3], width: f32, tip: f32) {
    let line: Vec<_> = line.iter().map(|p| *p * 0.001).collect();
    into.push(&line);
    let last = (line.len() - 1) as f32;
    into.radii.extend((0..line.len()).map(|i| {
        let t = i as f32 / last;
        0.0005 * width * (1.0 + (tip - 1.0) * t * t)
    }));
}
