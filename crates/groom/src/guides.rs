//! Guides on the CPU: the simulated strands.

use crate::{curve, scalp::ScalpMap, skin::MapProjection};
use glam::Vec3;

/// Guides with a fixed number of vertices each.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Guides {
    /// Vertices per guide, 3 to [`crate::MAX_GUIDE_VERTICES`].
    pub vertex_count: u32,
    /// Rest positions, groom space, meters: guide after guide, root first.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub positions: Vec<Vec3>,
    /// Stiffness multiplier from the scalp map, one per guide.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub stiffness: Vec<f32>,
    /// Number of render strands that each guide represents.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub strands: Vec<f32>,
    /// Whether the tip follows the head as the root does, one per guide.
    pub tip_pinned: Vec<bool>,
    /// Group number from the file, one per guide; empty without groups.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub groups: Vec<i32>,
}

impl Guides {
    /// Returns an empty set of guides with `vertex_count` vertices each.
    pub fn new(vertex_count: u32) -> Self {
        Self { vertex_count, ..Self::default() }
    }

    /// Returns the number of guides.
    pub fn len(&self) -> usize {
        self.stiffness.len()
    }

    /// Returns whether there are no guides.
    pub fn is_empty(&self) -> bool {
        self.stiffness.is_empty()
    }

    /// Returns the vertices of guide `i`.
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

    /// Multiplies the stiffness of every guide by the value of `map` at its root. `on` may be the center of the braincase
    /// (groom space, meters; [`SKULL_CENTER`](crate::mannequin::SKULL_CENTER) for the built-in head). The factor applies to bending and to the pull toward the rest pose. The simulation parameters define how both vary
    /// along the strand. The rest shape does not change.
    pub fn stiffen<'a>(&mut self, map: &ScalpMap, on: impl Into<MapProjection<'a>>) {
        let on = on.into();
        let n = self.vertex_count as usize;
        for (stiffness, guide) in self.stiffness.iter_mut().zip(self.positions.chunks_exact(n)) {
            *stiffness *= map.sample(on.at(guide[0]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiffness_map_scales_one_side() {
        let mut guides = Guides::new(3);
        for x in [-0.08f32, 0.0, 0.08] {
            guides.push(&[Vec3::new(x, 0.05, 0.0), Vec3::new(x, 0.1, 0.0)], 2.0, false);
        }
        let map = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 3.0 } else { 0.5 });
        guides.stiffen(&map, Vec3::ZERO);
        assert!((guides.stiffness[0] - 1.0).abs() < 1e-5 && (guides.stiffness[2] - 6.0).abs() < 1e-5);
        assert!((1.0..=6.0).contains(&guides.stiffness[1]));
        // Left and right refer to the head, not to the image.
        guides.stiffen(&ScalpMap::from_fn(64, |uv| 1.0 - uv.x), Vec3::ZERO);
        assert!(guides.stiffness[0] > 0.5 && guides.stiffness[2] < 3.0);
    }
}
