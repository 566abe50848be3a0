//! Render strands bound to guides, packed for the GPU.

pub mod binding;
pub mod strand;

pub use binding::{Influence, PackedRest, StrandBinding};
pub use strand::Strand;

use crate::{Guides, Strands};
use glam::Vec3;

/// Render strands with a fixed number of vertices each, in GPU layout.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct BoundStrands {
    /// Vertices per strand, 2 to [`crate::MAX_STRAND_VERTICES`].
    pub vertex_count: u32,
    /// Radius, seed and colors, one per strand.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub strands: Vec<Strand>,
    /// Guides and bounds, one per strand.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub bindings: Vec<StrandBinding>,
    /// Packed rest vertices, `vertex_count` per strand.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub rest: Vec<PackedRest>,
}

impl BoundStrands {
    /// Returns an empty set of strands with `vertex_count` vertices each.
    pub fn new(vertex_count: u32) -> Self {
        Self { vertex_count, ..Self::default() }
    }

    /// Returns the number of strands.
    pub fn len(&self) -> usize {
        self.strands.len()
    }

    /// Returns whether there are no strands.
    pub fn is_empty(&self) -> bool {
        self.strands.is_empty()
    }

    /// Adds a strand from `vertex_count` rest positions (groom space, meters), the radius at each as a fraction of
    /// `strand.radius`, and one to three influences in any order.
    pub fn push(&mut self, strand: Strand, rest: &[Vec3], radii: &[f32], influences: &[Influence]) {
        let mut binding = StrandBinding::default();
        binding.cover(rest);
        binding.follow(influences);
        self.rest.extend(rest.iter().zip(radii).map(|(p, radius)| PackedRest::pack(*p, *radius, &binding)));
        self.strands.push(strand);
        self.bindings.push(binding);
    }

    /// Returns the strands at rest, with radii, and with colors if every strand has one.
    pub fn unbound(&self) -> Strands {
        let mut strands = Strands::default();
        let count = self.vertex_count as usize;
        for (i, strand) in self.strands.iter().enumerate() {
            let (positions, radii) = self.vertices(i);
            strands.push(&positions);
            strands.radii.extend(radii.iter().map(|radius| strand.radius * radius));
        }
        let colors: Option<Vec<_>> = self.strands.iter().map(|strand| strand.colors(count)).collect();
        strands.colors = colors.into_iter().flatten().flatten().collect();
        strands
    }

    /// Returns the rest positions of strand `i` (groom space, meters), and the radius at each as a fraction.
    pub(crate) fn vertices(&self, i: usize) -> (Vec<Vec3>, Vec<f32>) {
        let n = self.vertex_count as usize;
        self.rest[i * n..(i + 1) * n].iter().map(|rest| rest.unpack(&self.bindings[i])).unzip()
    }

    /// Replaces what [`vertices`](Self::vertices) returns of strand `i`.
    #[cfg(feature = "edit")]
    pub(crate) fn reshape(&mut self, i: usize, line: &[Vec3], radii: &[f32]) {
        let (n, binding) = (self.vertex_count as usize, &mut self.bindings[i]);
        binding.cover(line);
        let vertices = self.rest[i * n..(i + 1) * n].iter_mut().zip(line).zip(radii);
        vertices.for_each(|((packed, p), radius)| *packed = PackedRest::pack(*p, *radius, binding));
    }

    /// Returns the rest positions of strand `i`, groom space, meters.
    pub fn rest_positions(&self, i: usize) -> impl Iterator<Item = Vec3> {
        let n = self.vertex_count as usize;
        self.rest[i * n..(i + 1) * n].iter().map(move |rest| rest.unpack(&self.bindings[i]).0)
    }
}

/// A groom ready for the GPU: guides to simulate and render strands that follow them.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Groom {
    /// Simulated guides.
    pub guides: Guides,
    /// Render strands.
    pub strands: BoundStrands,
}

impl Groom {
    /// Returns the minimum and maximum corner of the render strands at rest, groom space, meters.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        (0..self.strands.len())
            .flat_map(|i| self.strands.rest_positions(i))
            .map(|p| (p, p))
            .reduce(|(lo, hi), (p, _)| (lo.min(p), hi.max(p)))
    }

    /// Returns the number of triangles of all render strands, two per segment.
    pub fn triangles(&self) -> u64 {
        2 * self.strands.len() as u64 * u64::from(self.strands.vertex_count.saturating_sub(1))
    }
}

/// Returns the strand radius (meters) with which `count` strands cover a head like 100,000 real strands of 40 µm
/// radius. The power law lies between pairs of count and diameter that cover well in practice: 100,000 of 80 µm, 20,000
/// of 200 µm, 10,000 of 300 µm.
pub fn covering_radius(count: usize) -> f32 {
    const REAL_COUNT: f32 = 100_000.0;
    const REAL_RADIUS: f32 = 40e-6;
    (REAL_RADIUS * (REAL_COUNT / count.max(1) as f32).powf(0.56)).clamp(REAL_RADIUS, 12.0 * REAL_RADIUS)
}
