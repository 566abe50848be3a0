//! Keeps rest curves clear of the head.

use crate::random::Rng;
use crate::{scalp::Scalp, styles::Face};
use glam::Vec3;

/// Rounds of pushing out and restoring lengths.
const ROUNDS: usize = 2;

/// Push below which the stretch of segments is negligible, meters.
const TOLERABLE: f32 = 4e-4;

/// Fraction of a sampled distance that is trusted to be free. Exact distance fields would allow 1; blended and sampled
/// ones are less accurate.
const TRUST: f32 = 0.7;

pub(crate) struct Keeper<'a> {
    scalp: &'a dyn Scalp,
    face: Option<Face>,
    clearance: f32,
}

impl<'a> Keeper<'a> {
    pub(crate) fn new(scalp: &'a dyn Scalp, face: Option<Face>, clearance: f32) -> Self {
        Self { scalp, face, clearance }
    }

    /// Moves the vertices after the root out of the head and off the face, and restores the lengths of the segments as
    /// far as possible.
    pub(crate) fn keep(&self, line: &mut [Vec3], rng: &mut Rng) {
        let full = self.clearance * rng.range(0.6, 1.8);
        let mut lengths = [0.0f32; 64];
        for (length, w) in lengths.iter_mut().zip(line.windows(2)) {
            *length = w[0].distance(w[1]);
        }
        for round in 0..=ROUNDS {
            if self.push(line, full, &lengths) < TOLERABLE || round == ROUNDS {
                break;
            }
            for i in 1..line.len() {
                let edge = line[i] - line[i - 1];
                line[i] = line[i - 1] + edge.normalize_or(Vec3::NEG_Y) * lengths[i - 1];
            }
        }
    }

    /// Pushes vertices out. Returns the largest displacement, meters.
    fn push(&self, line: &mut [Vec3], full: f32, lengths: &[f32; 64]) -> f32 {
        let mut max_displacement = 0.0f32;
        let mut along = 0.0;
        let mut free = 0.0f32;
        for i in 1..line.len() {
            along += lengths[i - 1];
            // Skip vertices within the free distance of the last sample.
            free -= line[i].distance(line[i - 1]);
            if free > 0.0 {
                continue;
            }
            let mut p = line[i];
            if let Some(face) = self.face
                && face.depth(p) > 0.0
            {
                p = face.clear(p, p.x.signum());
            }
            let min_distance = full.min(0.15 * along + 1e-4);
            let mut d = self.scalp.distance(p);
            for _ in 0..4 {
                if d >= min_distance {
                    break;
                }
                p += self.scalp.normal(p) * (min_distance - d + 1e-5);
                d = self.scalp.distance(p);
            }
            let face_distance = self
                .face
                .map_or(1.0, |face| ((p - face.center).length() - face.radii.max_element()).max(0.0));
            if p != line[i] {
                max_displacement = max_displacement.max(p.distance(line[i]));
                line[i] = p;
                free = 0.0;
            } else {
                free = TRUST * (d - min_distance).min(face_distance);
            }
        }
        max_displacement
    }
}
