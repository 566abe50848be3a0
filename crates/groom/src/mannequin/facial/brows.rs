//! Eyebrows: short hairs along the ridge above each eye.

use super::{grow, in_front, push};
use crate::{Strands, random::Rng};
use glam::{Vec2, Vec3};

/// Hairs per brow. People have 250 to 500.
const HAIRS: u32 = 460;
const VERTICES: usize = 8;
const SEED: u32 = 0xb20;

/// Adds both brows, meters, with 8 vertices per strand.
///
/// Hairs stand up at the inner end and lie along the brow from there. They turn down at the upper edge and up at the
/// lower edge, so that they meet in a ridge.
pub fn brows(strands: &mut Strands) {
    for (side, seed) in [(1.0, SEED), (-1.0, SEED + 1)] {
        for i in 0..HAIRS {
            let rng = &mut Rng::new(seed, i);
            // Even along the brow, random across it.
            let along = (i as f32 + rng.unit()) / HAIRS as f32;
            // Denser in the middle than at both ends.
            let along = along + 0.045 * (std::f32::consts::TAU * along).sin();
            let across = 0.62 * rng.bell();
            if across.abs() > 1.0 {
                continue;
            }
            hair(strands, side, along, across, rng);
        }
    }
}

/// Returns the center of a brow (mm) at a fraction of its length from the nose, and half its width there.
fn cross_section(along: f32) -> (Vec2, f32) {
    let x = 11.0 + 43.0 * along;
    // An arch on the ridge of the sculpture, highest over the outer third of the eye.
    let y =
        129.4 + 4.2 * (1.0 - ((along - 0.6) / 0.6).powi(2)) - 2.6 * ((along - 0.6).max(0.0) / 0.4).powi(2);
    let half = 4.4 * (1.0 - 0.2 * along) * (1.0 - along.powi(4)) + 0.5;
    // The inner end is round.
    (Vec2::new(x, y), half * (along / 0.06).clamp(0.35, 1.0).sqrt())
}

fn hair(strands: &mut Strands, side: f32, along: f32, across: f32, rng: &mut Rng) {
    let (center, half) = cross_section(along);
    let tangent = (cross_section((along + 0.02).min(1.0)).0 - center).normalize_or(Vec2::X);
    let at = center + Vec2::new(-tangent.y, tangent.x) * (across * half);
    let root = in_front(side * at.x, at.y);
    // Hairs point up near the nose and lie along the brow from its first quarter on; those at the edges bend toward the
    // middle.
    let up = 1.25 * (1.0 - along / 0.28).max(0.0).powf(0.8) - 0.42 * across * (0.35 + 0.65 * along) + 0.1;
    let angle = up + 0.12 * rng.bell();
    let flat = Vec2::from_angle(angle).rotate(tangent);
    let bend = -0.35 * across - 0.25 * (1.0 - along) + 0.1 * rng.bell();
    let lift = rng.range(0.35, 0.6);
    let long = 5.2 + 4.2 * (std::f32::consts::PI * along.clamp(0.0, 1.0)).sin() + 0.7 * rng.bell();
    let line = grow(root, long.max(3.0), VERTICES, |t, out| {
        let flat = Vec2::from_angle(bend * t).rotate(flat);
        let flat = Vec3::new(side * flat.x, flat.y, 0.0);
        let flat = (flat - out * flat.dot(out)).normalize_or(flat);
        flat + out * (lift * (1.0 - 1.25 * t))
    });
    push(strands, &line, rng.range(0.065, 0.1), 0.25);
}
