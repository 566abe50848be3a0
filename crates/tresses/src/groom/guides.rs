//! Guides on the CPU: what is simulated.

use super::curve;
use glam::Vec3;

/// Guides with a fixed number of vertices each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guides {
    /// Vertices per guide, 3 to [`crate::constants::MAX_GUIDE_VERTICES`].
    pub vertex_count: u32,
    /// Rest positions, groom space, metres; guide after guide, root first.
    pub positions: Vec<Vec3>,
    /// One per guide: multiplier of the stiffness, from the scalp map.
    pub stiffness: Vec<f32>,
    /// One per guide: how many drawn strands it stands for.
    pub strands: Vec<f32>,
    /// One per guide: whether its tip follows the head, as its root does.
    pub tip_pinned: Vec<bool>,
}

impl Guides {
    /// No guides yet.
    pub fn new(vertex_count: u32) -> Self {
        Self { vertex_count, ..Self::default() }
    }

    /// The number of guides.
    pub fn len(&self) -> usize {
        self.stiffness.len()
    }

    /// Whether there is no guide.
    pub fn is_empty(&self) -> bool {
        self.stiffness.is_empty()
    }

    /// The vertices of guide `i`.
    pub fn guide(&self, i: usize) -> &[Vec3] {
        let n = self.vertex_count as usize;
        &self.positions[i * n..(i + 1) * n]
    }

    /// Adds a guide along `vertices`, resampled to equal steps of arc length.
    pub fn push(&mut self, vertices: &[Vec3], stiffness: f32, tip_pinned: bool) {
        self.positions.extend(curve::resample(vertices, self.vertex_count as usize));
        self.stiffness.push(stiffness);
        self.strands.push(1.0);
        self.tip_pinned.push(tip_pinned);
    }
}
