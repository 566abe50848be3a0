//! What is finer than the given strands: tufts, frizz and single hairs that stray.
//!
//! Strands that lie beside one given strand would be as parallel as a comb's teeth. They gather in tufts of
//! some millimetres, as hair does; where the given strands are nearer to each other than that, they are its
//! tufts, and what is between them fills. Only strands of one lead gather: what they do around
//! their paths is the same, so that curls stay, and none leaves its clump or its side of a parting.

use super::shape::{lengths, restore};
use super::{Fill, Grown, surface::Surface};
use crate::grow::unrest;
use crate::random::{Rng, smoothstep};
use glam::Vec3;
use std::collections::HashMap;

/// Distance between the centres of tufts, metres.
const SPACING: f32 = 0.0055;

/// From the first to the second distance of the given strands, against [`SPACING`], there come to be tufts.
const SPARSE: [f32; 2] = [0.5, 1.5];

/// The new strands that others gather around.
pub(super) struct Tufts {
    /// For each new strand the beginning of its centre's vertices, and how firm its tuft can be, 0 to 1;
    /// `None` for one that has no other.
    of: Vec<Option<(u32, f32)>>,
    /// The vertices of the centres.
    lines: Vec<Vec3>,
}

impl Tufts {
    /// The tufts of the new strands behind the first `given`, which `surface` has the roots of.
    pub(super) fn new(grown: &Grown, given: usize, surface: &Surface) -> Self {
        let mut tufts = Self { of: Vec::with_capacity(grown.parents.len()), lines: Vec::new() };
        let mut centres: HashMap<u32, Vec<u32>> = HashMap::new();
        for (i, parents) in grown.parents.iter().enumerate() {
            let line = grown.strands.strand(given + i);
            let apart = surface.spacing[surface.site(parents.strands[0])];
            let firm = smoothstep(SPARSE[0], SPARSE[1], apart / SPACING);
            let known = centres.entry(parents.strands[0]).or_default();
            let reach = |at: u32| (tufts.lines[at as usize].distance_squared(line[0]), at);
            let near = known.iter().map(|at| reach(*at)).min_by(|a, b| a.0.total_cmp(&b.0));
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

    /// Draws new strand `i` to the centre of its tuft and lets it stray; its edges keep their lengths.
    pub(super) fn comb(&self, i: usize, options: &Fill, rng: &mut Rng, line: &mut [Vec3]) {
        let last = (line.len() - 1) as f32;
        let lengths = lengths(line);
        let stray = rng.unit();
        // Those that stray most belong to none.
        let held = if stray < options.unrest.flyaways { 0.3 } else { rng.range(0.5, 1.0) };
        if let Some((at, firm)) = self.of[i] {
            let mut own = Rng::new(options.seed ^ 0xbeef, at);
            let strength = options.tufts * firm * own.range(0.4, 1.0) * held;
            let centre = &self.lines[at as usize..][..line.len()];
            for (k, (p, middle)) in line.iter_mut().zip(centre).enumerate().skip(1) {
                *p = p.lerp(*middle, strength * smoothstep(0.05, 0.9, k as f32 / last));
            }
        }
        unrest(&options.unrest, stray, rng, line);
        restore(line, &lengths);
    }
}
