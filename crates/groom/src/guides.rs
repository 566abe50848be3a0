//! Guides on the CPU: the strands that are simulated.

use crate::{
    curve,
    scalp::{ScalpMap, scalp_uv},
};
use glam::Vec3;

/// Guides with a fixed number of vertices each.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Guides {
    /// Vertices per guide, 3 to [`crate::MAX_GUIDE_VERTICES`].
    pub vertex_count: u32,
    /// Rest positions, groom space, metres; guide after guide, root first.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub positions: Vec<Vec3>,
    /// One per guide: multiplier of the stiffness, from the scalp map.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub stiffness: Vec<f32>,
    /// One per guide: how many drawn strands it stands for.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub strands: Vec<f32>,
    /// One per guide: whether its tip follows the head, as its root does.
    pub tip_pinned: Vec<bool>,
    /// One per guide: the number of the group that its file has it in; or empty.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub groups: Vec<i32>,
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

    /// Multiplies the stiffness of every guide by what `map` has at its root, seen from the middle of
    /// the braincase `skull` (groom space, metres; [`SKULL_CENTRE`](crate::mannequin::SKULL_CENTRE)
    /// for the built-in head). Bending and the pull to the rest pose both follow it; along the strand they
    /// change as the simulation's parameters say. The shape at rest stays what it is.
    pub fn stiffen(&mut self, map: &ScalpMap, skull: Vec3) {
        let n = self.vertex_count as usize;
        for (stiffness, guide) in self.stiffness.iter_mut().zip(self.positions.chunks_exact(n)) {
            *stiffness *= map.sample(scalp_uv(guide[0] - skull));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_makes_one_side_stiffer() {
        let mut guides = Guides::new(3);
        for x in [-0.08f32, 0.0, 0.08] {
            guides.push(&[Vec3::new(x, 0.05, 0.0), Vec3::new(x, 0.1, 0.0)], 2.0, false);
        }
        let map = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 3.0 } else { 0.5 });
        guides.stiffen(&map, Vec3::ZERO);
        assert!((guides.stiffness[0] - 1.0).abs() < 1e-5 && (guides.stiffness[2] - 6.0).abs() < 1e-5);
        assert!((1.0..=6.0).contains(&guides.stiffness[1]));
        // The sides are those of the head, not of the picture.
        guides.stiffen(&ScalpMap::from_fn(64, |uv| 1.0 - uv.x), Vec3::ZERO);
        assert!(guides.stiffness[0] > 0.5 && guides.stiffness[2] < 3.0);
    }
}
