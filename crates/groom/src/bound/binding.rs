//! How a drawn strand follows its guides.
//!
//! With guide samples `g_k(t)`, their rotations `R_k(t)` and their rest positions `ḡ_k(t)`, the vertex with
//! rest position `p̄` is drawn at `Σ w_k (g_k(t_k) + R_k(t_k) (p̄ - ḡ_k(t_k)))`. One guide gives a clump,
//! three give multi-strand interpolation, and at rest the strand is exact for any weights.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The guides of one drawn strand and the box of its rest vertices.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct StrandBinding {
    /// Smallest corner of the rest vertices, groom space, metres.
    pub origin: Vec3,
    /// Edge of the cube that holds the rest vertices, metres.
    pub extent: f32,
    /// Guide indices; the first has the largest weight.
    pub guides: [u32; 3],
    /// Weight of the second guide; the first has what is left.
    pub weight_b: f32,
    /// For each guide: the parameter that the strand's tip follows. A strand vertex at
    /// the fraction `s` of its own strand reads guide `k` at `min(s * scale[k], 1)`.
    pub scale: [f32; 3],
    /// Weight of the third guide.
    pub weight_c: f32,
}

/// A rest vertex: three 16-bit fractions of the strand's box, an 8-bit radius fraction, and how
/// much nearer to the obstacles it rests than strands keep from them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct PackedRest {
    /// `x | y << 16`.
    pub xy: u32,
    /// `z | radius << 16 | sunk << 24`, the radius as a fraction of [`super::Strand::radius`].
    pub z_radius_sunk: u32,
}

/// One step of [`PackedRest::sunk`], metres.
pub const SUNK_STEP: f32 = 1.0 / 8e3;

impl PackedRest {
    /// Packs `position` within the box of `binding`; at most `extent / 131070` metres off per axis.
    pub fn pack(position: Vec3, radius: f32, binding: &StrandBinding) -> Self {
        let fraction = (position - binding.origin) / binding.extent.max(1e-12);
        let bits = |v: f32, most: f32| (v.clamp(0.0, 1.0) * most + 0.5) as u32;
        Self {
            xy: bits(fraction.x, 65_535.0) | bits(fraction.y, 65_535.0) << 16,
            z_radius_sunk: bits(fraction.z, 65_535.0) | bits(radius, 255.0) << 16,
        }
    }

    /// The position (groom space, metres) and the radius fraction.
    pub fn unpack(&self, binding: &StrandBinding) -> (Vec3, f32) {
        let bits = |v: u32| (v & 0xffff) as f32 / 65_535.0;
        let fraction = Vec3::new(bits(self.xy), bits(self.xy >> 16), bits(self.z_radius_sunk));
        let radius = (self.z_radius_sunk >> 16 & 0xff) as f32 / 255.0;
        (binding.origin + fraction * binding.extent, radius)
    }

    /// The same vertex, resting `sunk` metres nearer to the obstacles than strands keep from them;
    /// rounded up to a [`SUNK_STEP`]. From 254 steps (32 mm) on it may be as deep as it likes.
    #[must_use]
    pub fn sink(self, sunk: f32) -> Self {
        let steps = (sunk / SUNK_STEP).ceil().clamp(0.0, 255.0) as u32;
        Self { z_radius_sunk: (self.z_radius_sunk & 0xff_ffff) | steps << 24, ..self }
    }

    /// How much nearer than strands keep from the obstacles it may be, metres.
    pub fn sunk(&self) -> f32 {
        match self.z_radius_sunk >> 24 {
            255 => f32::INFINITY,
            steps => steps as f32 * SUNK_STEP,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rest_vertex_survives_packing() {
        let binding =
            StrandBinding { origin: Vec3::new(-0.1, 1.5, 0.02), extent: 0.3, ..StrandBinding::default() };
        let p = Vec3::new(0.05, 1.61, 0.17);
        for sunk in [-1.0f32, 0.0, 0.4e-3, 9e-3, 1.0] {
            let packed = PackedRest::pack(p, 0.7, &binding).sink(0.01).sink(sunk);
            let (back, radius) = packed.unpack(&binding);
            assert!(back.distance(p) < 5e-6 && (radius - 0.7).abs() < 0.002, "{back} {radius}");
            // Never less than asked, and by no more than a step.
            let kept = packed.sunk();
            assert!(kept >= sunk && (sunk > 0.032 || kept <= sunk.max(0.0) + SUNK_STEP), "{sunk} {kept}");
        }
        assert_eq!(PackedRest::pack(p, 0.7, &binding).sunk(), 0.0);
    }
}
