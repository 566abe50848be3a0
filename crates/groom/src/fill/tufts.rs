//! Detail finer than the input strands: tufts, frizz and stray hairs.
//!
//! Strands beside one input strand would be as parallel as the teeth of a comb. Real hair gathers in tufts of some
//! millimeters. Input strands that are closer together are tufts already, and new strands fill the space between them.
//! Only strands with the same lead (first parent) gather: they have the same detail around their paths, so curls stay,
//! and no strand leaves its clump or its side of a parting.

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
    /// For each new strand, the first vertex of its center in `center_vertices` and the maximum strength of its tuft,
    /// 0 to 1; `None` for a strand that is a center itself.
    memberships: Vec<Option<(u32, f32)>>,
    /// Vertices of the center strands.
    center_vertices: Vec<Vec3>,
}

impl Tufts {
    /// Groups the new strands into tufts. `new_strands.strands` begins with the `input_count` input strands. `surface`
    /// provides the root spacing.
    pub(super) fn new(new_strands: &NewStrands, input_count: usize, surface: &Surface) -> Self {
        let mut tufts =
            Self { memberships: Vec::with_capacity(new_strands.parents.len()), center_vertices: Vec::new() };
        // By lead: the first vertex of each center in `center_vertices`.
        let mut centers: HashMap<u32, Vec<u32>> = HashMap::new();
        for (i, parents) in new_strands.parents.iter().enumerate() {
            let line = new_strands.strands.strand(input_count + i);
            let spacing = surface.spacing[surface.site(parents.strands[0])];
            let max_strength = smoothstep(SPARSE[0], SPARSE[1], spacing / SPACING);
            let lead_centers = centers.entry(parents.strands[0]).or_default();
            let squared_distance =
                |first: u32| (tufts.center_vertices[first as usize].distance_squared(line[0]), first);
            let nearest =
                lead_centers.iter().map(|first| squared_distance(*first)).min_by(|a, b| a.0.total_cmp(&b.0));
            tufts.memberships.push(match nearest {
                Some((squared, first)) if squared < SPACING * SPACING => Some((first, max_strength)),
                _ => {
                    lead_centers.push(tufts.center_vertices.len() as u32);
                    tufts.center_vertices.extend_from_slice(line);
                    None
                }
            });
        }
        tufts
    }

    /// Pulls new strand `i` toward the center of its tuft and adds frizz and drift; its segments keep their lengths.
    pub(super) fn comb(&self, i: usize, options: &Fill, rng: &mut Rng, line: &mut [Vec3]) {
        let last = (line.len() - 1) as f32;
        let lengths = lengths(line);
        let stray = rng.unit();
        // Flyaways follow their tuft only weakly.
        let follow = if stray < options.variation.flyaways { 0.3 } else { rng.range(0.5, 1.0) };
        if let Some((first, max_strength)) = self.memberships[i] {
            let mut tuft_rng = Rng::new(options.seed ^ 0xbeef, first);
            let strength = options.tufts * max_strength * tuft_rng.range(0.4, 1.0) * follow;
            let center = &self.center_vertices[first as usize..][..line.len()];
            for (k, (point, center_point)) in line.iter_mut().zip(center).enumerate().skip(1) {
                *point = point.lerp(*center_point, strength * smoothstep(0.05, 0.9, k as f32 / last));
            }
        }
        add_variation(&options.variation, stray, rng, line);
        restore(line, &lengths);
    }
}
