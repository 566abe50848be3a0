//! Detail finer than the input strands: tufts, frizz and stray hairs.
//!
//! Strands beside one input strand would be as parallel as the teeth of a comb. Real hair gathers in tufts of some
//! millimeters. Input strands that are closer together are tufts already, and new strands fill the space between them.
//! Only strands with the same lead gather: they have the same detail around their paths, so curls stay, and no strand
//! leaves its clump or its side of a parting.

use super::shape::{lengths, restore};
use super::{Fill, NewStrands, surface::Surface};
use crate::grow::add_variation;
use crate::random::{Rng, smoothstep};
use glam::Vec3;
use std::collections::HashMap;

/// Distance between the centers of tufts, meters.
const SPACING: f32 = 0.0055;

/// Range of the spacing of the input strands, relative to [`SPACING`], over which tufts fade in.
const SPARSE: [f32; 2] = [0.5, 1.5];

/// Tufts of new strands, each around a center strand.
pub(super) struct Tufts {
    /// For each new strand, the first vertex of its center in `lines` and the maximum strength of its tuft, 0 to 1;
    /// `None` for a strand that is a center itself.
    of: Vec<Option<(u32, f32)>>,
    /// Vertices of the centers.
    lines: Vec<Vec3>,
}

impl Tufts {
    /// Groups the new strands, which follow the first `given` ones, into tufts. `surface` provides the root spacing.
    pub(super) fn new(new_strands: &NewStrands, given: usize, surface: &Surface) -> Self {
        let mut tufts = Self { of: Vec::with_capacity(new_strands.parents.len()), lines: Vec::new() };
        let mut centers: HashMap<u32, Vec<u32>> = HashMap::new();
        for (i, parents) in new_strands.parents.iter().enumerate() {
            let line = new_strands.strands.strand(given + i);
            let spacing = surface.spacing[surface.site(parents.strands[0])];
            let firm = smoothstep(SPARSE[0], SPARSE[1], spacing / SPACING);
            let known = centers.entry(parents.strands[0]).or_default();
            let distance_to = |at: u32| (tufts.lines[at as usize].distance_squared(line[0]), at);
            let near = known.iter().map(|at| distance_to(*at)).min_by(|a, b| a.0.total_cmp(&b.0));
            tufts.of.push(match near {
                Some((squared, at)) if squared < SPACING * SPACING => Some((at, firm)),
                _ => {
                    known.push(tufts.lines.len() as u32);
                    tufts.lines.extend_from_slice(line);
                    None
                }
            });
        }
        tufts
    }

    /// Pulls new strand `i` toward the center of its tuft and adds stray offsets; edges keep their lengths.
    pub(super) fn comb(&self, i: usize, options: &Fill, rng: &mut Rng, line: &mut [Vec3]) {
        let last = (line.len() - 1) as f32;
        let lengths = lengths(line);
        let stray = rng.unit();
        // Flyaways follow their tuft only weakly.
        let held = if stray < options.variation.flyaways { 0.3 } else { rng.range(0.5, 1.0) };
        if let Some((at, firm)) = self.of[i] {
            let mut own = Rng::new(options.seed ^ 0xbeef, at);
            let strength = options.tufts * firm * own.range(0.4, 1.0) * held;
            let center = &self.lines[at as usize..][..line.len()];
            for (k, (p, center_point)) in line.iter_mut().zip(center).enumerate().skip(1) {
                *p = p.lerp(*center_point, strength * smoothstep(0.05, 0.9, k as f32 / last));
            }
        }
        add_variation(&options.variation, stray, rng, line);
        restore(line, &lengths);
    }
}
