//! Number of strands of each kind.

use super::bind::Scaffold;
use super::{Growth, StrandKind};
use crate::random::smoothstep;
use crate::scalp::{Scalp, scalp_uv};
use crate::styles::StyledGuides;
use glam::{Vec2, Vec3};

/// Returns the numbers of clump-based strands and of multi-strands.
pub(crate) fn totals(
    scaffold: &Scaffold,
    styled: &StyledGuides,
    growth: &Growth,
    scalp: &dyn Scalp,
) -> [usize; 2] {
    if let Some(total) = growth.strand_count {
        let total = total as usize;
        return match growth.kind {
            StrandKind::Clump => [total, 0],
            StrandKind::Multi => [0, total],
            StrandKind::Both => {
                let clump = (total as f32 * growth.clump_fraction) as usize;
                [clump, total - clump]
            }
        };
    }
    let skull = scalp.landmarks().skull;
    let clump = || -> usize {
        (0..styled.guides.len())
            .map(|g| {
                let root = scaffold.root(g);
                let density =
                    clump_density(growth, styled.hairline.inside(root), 1.0, scalp_uv(root - skull));
                (density * growth.clump_count as f32) as usize
            })
            .sum()
    };
    let multi = || -> usize {
        scaffold
            .triangles()
            .iter()
            .map(|t| {
                let root: Vec3 = t.iter().map(|&g| scaffold.root(g as usize)).sum::<Vec3>() / 3.0;
                let density =
                    multi_density(growth, styled.hairline.inside(root), 1.0, scalp_uv(root - skull));
                (density * growth.multi_count as f32) as usize
            })
            .sum()
    };
    match growth.kind {
        StrandKind::Clump => [clump(), 0],
        StrandKind::Multi => [0, multi()],
        StrandKind::Both => [clump(), multi()],
    }
}

/// Returns the density of clump-based strands at a scalp point `edge` meters inside the hairline.
pub(crate) fn clump_density(growth: &Growth, edge: f32, open: f32, uv: Vec2) -> f32 {
    growth.clump_map.as_ref().map_or_else(|| fading(edge, open), |map| map.sample(uv))
}

/// Returns the density of multi-strands at a scalp point `edge` meters inside the hairline.
pub(crate) fn multi_density(growth: &Growth, edge: f32, open: f32, uv: Vec2) -> f32 {
    growth.density_map.as_ref().map_or_else(|| fading(edge, open), |map| map.sample(uv))
}

/// Returns how exposed a scalp point is, 0 to 1: beside the parting and around the whorl, no hair covers the roots.
pub(crate) fn open(styled: &StyledGuides, p: Vec3, parting_distance: f32) -> f32 {
    match &styled.parting {
        Some(_) => (1.0 - smoothstep(0.003, 0.01, parting_distance))
            .max(1.0 - smoothstep(0.006, 0.018, p.distance(styled.whorl))),
        None => 1.0 - smoothstep(0.01, 0.035, p.distance(styled.whorl)),
    }
}

/// Returns a density that fades over the last centimeter to the hairline and is greatest where the scalp is exposed.
fn fading(edge: f32, open: f32) -> f32 {
    let forehead = 1.0 - smoothstep(0.012, 0.03, edge);
    (0.15 + 0.85 * smoothstep(0.0, 0.011, edge)) * (0.4 + (0.6 * open).max(0.3 * forehead))
}
