//! Guides for single strands, for brushes that plant hair.

use super::{Finder, Shapes};
use crate::{Guides, Strands, bound::Influence, curve};
use glam::Vec3;

/// Finds the guides that suit a strand.
pub(crate) struct GuideFinder {
    shapes: Shapes,
    finder: Finder,
    lengths: Vec<f32>,
}

impl GuideFinder {
    pub(crate) fn new(guides: &Guides) -> Self {
        let mut lines = Strands::default();
        (0..guides.len()).for_each(|i| lines.push(guides.guide(i)));
        lines.tip_pinned.clone_from(&guides.tip_pinned);
        let shapes = Shapes::new(&lines, lines.len());
        let guide_strands: Vec<u32> = (0..lines.len() as u32).collect();
        let lengths = lines.iter().map(|line| curve::length(line).max(1e-9)).collect();
        Self { finder: Finder::new(&shapes, &guide_strands), shapes, lengths }
    }

    /// Returns up to three guides for a strand along `line`, as [`bind`] chooses them. A guide that `suits` rejects is
    /// used only if it rejects all candidates.
    pub(crate) fn nearest(&self, line: &[Vec3], pinned: bool, suits: impl Fn(u32) -> bool) -> Vec<Influence> {
        let mut found = self.finder.nearest(&self.shapes, &Shapes::of(line), pinned, suits);
        let length = curve::length(line);
        found.iter_mut().for_each(|it| it.scale = length / self.lengths[it.guide as usize]);
        found
    }
}
