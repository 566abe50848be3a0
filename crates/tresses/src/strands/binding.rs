//! How a drawn strand hangs on its guides.
//!
//! With guide samples `g_k(t)`, their rotations `R_k(t)` and their rest positions `ḡ_k(t)`, the
//! vertex that rests at `p̄` is drawn at `Σ w_k (g_k(t_k) + R_k(t_k) (p̄ - ḡ_k(t_k)))`. One guide
//! makes a clump, three make multi-strand interpolation, and at rest the strand is exact whatever
//! the weights are.

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
    /// For each guide: the parameter at which the strand's tip hangs on it. A strand vertex at
    /// the fraction `s` of its own strand reads guide `k` at `min(s * scale[k], 1)`.
    pub scale: [f32; 3],
    /// Weight of the third guide.
    pub weight_c: f32,
}

/// A rest vertex: three 16-bit fractions of the strand's box and a 16-bit radius fraction.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct PackedRest {
    /// `x | y << 16`.
    pub xy: u32,
    /// `z | radius << 16`, the radius as a fraction of [`super::Strand::radius`].
    pub z_radius: u32,
}

impl PackedRest {
    /// Packs `position` within the box of `binding`; at most `extent / 131070` metres off per axis.
    pub fn pack(position: Vec3, radius: f32, binding: &StrandBinding) -> Self {
        let fraction = (position - binding.origin) / binding.extent.max(1e-12);
        let bits = |v: f32| (v.clamp(0.0, 1.0) * 65_535.0 + 0.5) as u32;
        Self {
            xy: bits(fraction.x) | bits(fraction.y) << 16,
            z_radius: bits(fraction.z) | bits(radius) << 16,
        }
    }

    /// The position (groom space, metres) and the radius fraction.
    pub fn unpack(&self, binding: &StrandBinding) -> (Vec3, f32) {
        let bits = |v: u32| (v & 0xffff) as f32 / 65_535.0;
        let fraction = Vec3::new(bits(self.xy), bits(self.xy >> 16), bits(self.z_radius));
        (binding.origin + fraction * binding.extent, bits(self.z_radius >> 16))
    }
}
