//! How many strands of each kind.

use super::bind::Scaffold;
use super::{Growth, Kind};
use crate::groom::styles::random::smoothstep;
use crate::groom::styles::{Scalp, StyledGuides, scalp_uv};
use glam::{Vec2, Vec3};

/// The numbers of clump-based and of multi-strands.
pub(crate) fn totals(
    scaffold: &Scaffold,
    styled: &StyledGuides,
    growth: &Growth,
    scalp: &dyn Scalp,
) -> [usize; 2] {
    if let Some(total) = growth.strand_count {
        let total = total as usize;
        return match growth.kind {
            Kind::Clump => [total, 0],
            Kind::Multi => [0, total],
            Kind::Both => {
                let clump = (total as f32 * growth.clump_share) as usize;
                [clump, total - clump]
            }
        };
    }
    let skull = scalp.landmarks().skull;
    let clump = || -> usize {
        (0..styled.guides.len())
            .map(|g| {
                let root = scaffold.root(g);
                let density = clump_density(styled, growth, root, scalp_uv(root - skull));
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
                let density = multi_density(styled, growth, root, scalp_uv(root - skull));
                (density * growth.multi_count as f32) as usize
            })
            .sum()
    };
    match growth.kind {
        Kind::Clump => [clump(), 0],
        Kind::Multi => [0, multi()],
        Kind::Both => [clump(), multi()],
    }
}

/// Density of clump-based strands at a scalp point.
pub(crate) fn clump_density(styled: &StyledGuides, growth: &Growth, p: Vec3, uv: Vec2) -> f32 {
    growth.clump_map.as_ref().map_or_else(|| fading(styled, p), |map| map.sample(uv))
}

/// Density of multi-strands at a scalp point.
pub(crate) fn multi_density(styled: &StyledGuides, growth: &Growth, p: Vec3, uv: Vec2) -> f32 {
    growth.density_map.as_ref().map_or_else(|| fading(styled, p), |map| map.sample(uv))
}

/// Thinning out over the last centimetre to the hairline, and fullest where nothing lies above the
/// roots: at the parting and behind the forehead.
fn fading(styled: &StyledGuides, p: Vec3) -> f32 {
    let edge = styled.hairline.inside(p);
    let beside = styled.parting.as_ref().map_or(1.0, |parting| parting.nearest(p).distance(p));
    let open = (1.0 - smoothstep(0.004, 0.012, beside)).max(1.0 - smoothstep(0.012, 0.03, edge));
    (0.15 + 0.85 * smoothstep(0.0, 0.011, edge)) * (0.6 + 0.4 * open)
}
