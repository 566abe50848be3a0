//! Eyelashes: along the line where the closed lids meet.

use super::{grow, in_front, push};
use crate::{Strands, random::Rng};
use glam::Vec3;

/// Hairs per upper and per lower lid. People have 90 to 150 above, half as many below.
const HAIRS: [u32; 2] = [130, 70];
const VERTICES: usize = 8;
const SEED: u32 = 0x1a5;

/// Adds the lashes of both closed eyes, meters, with 8 vertices per strand.
pub fn lashes(strands: &mut Strands) {
    for (side, eye) in [(1.0, 0), (-1.0, 1)] {
        for (eyelid, count) in HAIRS.iter().enumerate() {
            for i in 0..*count {
                let rng = &mut Rng::new(SEED + 2 * eye + eyelid as u32, i);
                // -1 at the inner corner, 1 at the outer.
                let t = -0.86 + 1.78 * (i as f32 + rng.unit()) / *count as f32;
                hair(strands, side, eyelid == 0, t, rng);
            }
        }
    }
}

fn hair(strands: &mut Strands, side: f32, upper: bool, t: f32, rng: &mut Rng) {
    let along = (1.0 - t * t).max(0.0);
    // The seam of the lids as in the sculpture. Lashes leave the edge of a lid in two or three rows.
    let seam = 108.2 - 3.2 * along + 0.9 * t;
    let row = rng.range(0.0, 0.7);
    let y = seam + if upper { 0.25 + row } else { -0.9 - row };
    let root = in_front(side * (31.5 + 16.5 * t), y);
    // Lashes spread like a fan and gather in little points. On closed lids, the upper ones point down and turn up again
    // at their tips.
    let lock = ((t * 21.0).round() / 21.0 - t) * if upper { 4.0 } else { 3.0 };
    let fan = 0.2 + 0.75 * t + lock + 0.07 * rng.bell();
    let (from, to, long) = match upper {
        true => (-0.85, 0.5, 5.6 + 2.6 * along + 1.2 * t.max(0.0)),
        false => (-0.7, -0.25, 3.0 + 1.3 * along + 0.5 * t.max(0.0)),
    };
    let droop = from + 0.12 * rng.bell();
    let line = grow(root, long * rng.range(0.8, 1.05), VERTICES, |t, _| {
        Vec3::new(side * fan * (1.0 - 0.3 * t), droop + (to - droop) * t, 0.85)
    });
    push(strands, &line, rng.range(0.07, 0.1), 0.15);
}
