//! Color of hair on the skin under it, so that gaps between cards do not look bald.

use super::lines::Lines;
use crate::{TriMesh, near::PointTree, progress::in_parallel};
use glam::Vec3;
use std::f32::consts::PI;

/// Distance from a root within which hair colors the skin, meters.
const RADIUS: f32 = 0.008;
/// Number of roots by which the density at a vertex is measured.
const COUNT: usize = 16;
/// Length of the part of a strand that lies over the skin near its root, meters.
const LYING: f32 = 0.03;
/// Brightness of the roots against the color of the hair: they are in its shade.
const SHADED: f32 = 0.5;

/// Hair on the vertices of the head.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardScalp {
    /// Fraction of the skin at each vertex that hair covers, 0 to 1.
    pub cover: Vec<f32>,
    /// Color of that hair, linear, without pigment unless strands have colors.
    pub colors: Vec<Vec3>,
}

impl CardScalp {
    pub(super) fn new(head: &TriMesh, lines: &Lines<'_>) -> Self {
        let first = |i: usize| lines.strands.range(i).start;
        let roots: Vec<Vec3> = (0..lines.strands.len()).map(|i| lines.strands.positions[first(i)]).collect();
        let tree = PointTree::new(&roots);
        let color = |i: usize| lines.strands.colors.get(first(i)).copied().unwrap_or(Vec3::ONE);
        let found = in_parallel(&head.positions, |p| {
            let mut near = Vec::new();
            tree.nearest(*p, COUNT, RADIUS, &mut near);
            // The area in which these roots are; with fewer than asked for, all of the reach.
            let radius = if near.len() < COUNT { RADIUS } else { near[COUNT - 1].0.sqrt().max(1e-4) };
            let width: f32 = near.iter().map(|(_, i)| 2.0 * lines.radii[first(*i as usize)]).sum();
            let cover = 1.0 - (-width * LYING / (PI * radius * radius)).exp();
            let sum: Vec3 = near.iter().map(|(_, i)| color(*i as usize)).sum();
            (cover, SHADED * sum / near.len().max(1) as f32)
        });
        let (cover, colors) = found.into_iter().unzip();
        Self { cover, colors }
    }
}
