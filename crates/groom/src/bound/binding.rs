//! Binding of a render strand to its guides.
//!
//! The vertex with rest position `p̄` is drawn at `Σ w_k (g_k(t_k) + R_k(t_k) (p̄ - ḡ_k(t_k)))`, where `g_k(t)` is a
//! point of guide `k`, `R_k(t)` its rotation and `ḡ_k(t)` its rest position. One guide gives a clump, three give
//! multi-strand interpolation. At rest, the strand is exact for any weights.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Guides of one render strand, and the bounding cube of its rest vertices.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct StrandBinding {
    /// Minimum corner of the rest vertices, groom space, meters.
    pub origin: Vec3,
    /// Edge of the cube that contains the rest vertices, meters.
    pub extent: f32,
    /// Guide indices; the first has the largest weight.
    pub guides: [u32; 3],
    /// Weight of the second guide. The first guide has the rest of the weight.
    pub weight_b: f32,
    /// For each guide, the parameter that the strand's tip follows. A strand vertex at the fraction `s` of the strand
    /// samples guide `k` at `min(s * scale[k], 1)`.
    pub scale: [f32; 3],
    /// Weight of the third guide.
    pub weight_c: f32,
}

/// Influence of one guide on a render strand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influence {
    /// Index of the guide.
    pub guide: u32,
    /// Weight of the guide; the weights of a strand sum to 1.
    pub weight: f32,
    /// Parameter of the guide (0 root, 1 tip) that the strand's tip follows.
    pub scale: f32,
}

impl StrandBinding {
    /// Follows other guides, at most three. The rest vertices stay.
    pub(crate) fn follow(&mut self, influences: &[Influence]) {
        let mut sorted = [Influence::default(); 3];
        sorted[..influences.len()].copy_from_slice(influences);
        sorted[..influences.len()].sort_by(|a, b| b.weight.total_cmp(&a.weight));
        self.guides = sorted.map(|influence| influence.guide);
        (self.weight_b, self.weight_c) = (sorted[1].weight, sorted[2].weight);
        self.scale = sorted.map(|influence| influence.scale);
    }

    /// Sets the cube to one that holds `line`.
    pub(crate) fn cover(&mut self, line: &[Vec3]) {
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (lo, hi) = line.iter().fold(empty, |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        (self.origin, self.extent) = (lo, (hi - lo).max_element());
    }

    /// Returns the influences that have a weight.
    pub(crate) fn influences(&self) -> impl Iterator<Item = Influence> {
        let weights = [1.0 - self.weight_b - self.weight_c, self.weight_b, self.weight_c];
        let all = self.guides.into_iter().zip(weights).zip(self.scale);
        let all = all.map(|((guide, weight), scale)| Influence { guide, weight, scale });
        all.enumerate().filter(|(k, it)| *k == 0 || it.weight > 0.0).map(|(_, it)| it)
    }

    /// Returns each guide that has a weight, with the weight.
    pub fn weighted(&self) -> impl Iterator<Item = (usize, f32)> {
        self.influences().map(|it| (it.guide as usize, it.weight))
    }
}

/// A packed rest vertex: three 16-bit fractions of the strand's bounding cube, an 8-bit radius fraction, and an 8-bit
/// depth inside the clearance that strands keep from obstacles.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct PackedRest {
    /// `x | y << 16`.
    pub xy: u32,
    /// `z | radius << 16 | penetration << 24`. The radius is a fraction of [`super::Strand::radius`].
    pub z_radius_penetration: u32,
}

/// Quantization step of [`PackedRest::penetration`], meters.
pub const PENETRATION_STEP: f32 = 1.0 / 8e3;

impl PackedRest {
    /// Packs `position` relative to the bounding cube of `binding`. The error is at most `extent / 131070` meters per
    /// axis.
    pub fn pack(position: Vec3, radius: f32, binding: &StrandBinding) -> Self {
        let fraction = (position - binding.origin) / binding.extent.max(1e-12);
        let bits = |v: f32, max: f32| (v.clamp(0.0, 1.0) * max + 0.5) as u32;
        Self {
            xy: bits(fraction.x, 65_535.0) | bits(fraction.y, 65_535.0) << 16,
            z_radius_penetration: bits(fraction.z, 65_535.0) | bits(radius, 255.0) << 16,
        }
    }

    /// Returns the position (groom space, meters) and the radius fraction.
    pub fn unpack(&self, binding: &StrandBinding) -> (Vec3, f32) {
        let bits = |v: u32| (v & 0xffff) as f32 / 65_535.0;
        let fraction = Vec3::new(bits(self.xy), bits(self.xy >> 16), bits(self.z_radius_penetration));
        let radius = (self.z_radius_penetration >> 16 & 0xff) as f32 / 255.0;
        (binding.origin + fraction * binding.extent, radius)
    }

    /// Returns the vertex with a rest depth of `sunk` meters inside the clearance that strands keep from obstacles,
    /// rounded up to a [`PENETRATION_STEP`]. Above 254 steps (32 mm), the depth is unlimited.
    #[must_use]
    pub fn with_penetration(self, penetration: f32) -> Self {
        let steps = (penetration / PENETRATION_STEP).ceil().clamp(0.0, 255.0) as u32;
        Self { z_radius_penetration: (self.z_radius_penetration & 0xff_ffff) | steps << 24, ..self }
    }

    /// Returns how far inside the clearance from obstacles the vertex may be, meters.
    pub fn penetration(&self) -> f32 {
        match self.z_radius_penetration >> 24 {
            255 => f32::INFINITY,
            steps => steps as f32 * PENETRATION_STEP,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_rest_vertex_round_trips() {
        let binding =
            StrandBinding { origin: Vec3::new(-0.1, 1.5, 0.02), extent: 0.3, ..StrandBinding::default() };
        let p = Vec3::new(0.05, 1.61, 0.17);
        for sunk in [-1.0f32, 0.0, 0.4e-3, 9e-3, 1.0] {
            let packed = PackedRest::pack(p, 0.7, &binding).with_penetration(0.01).with_penetration(sunk);
            let (back, radius) = packed.unpack(&binding);
            assert!(back.distance(p) < 5e-6 && (radius - 0.7).abs() < 0.002, "{back} {radius}");
            // Never less than requested, and at most one step more.
            let kept = packed.penetration();
            assert!(
                kept >= sunk && (sunk > 0.032 || kept <= sunk.max(0.0) + PENETRATION_STEP),
                "{sunk} {kept}"
            );
        }
        assert_eq!(PackedRest::pack(p, 0.7, &binding).penetration(), 0.0);
    }
}
