//! Per-strand data for shading.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Shading data of one render strand.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Strand {
    /// The largest radius along the strand, meters; the vertices store fractions of it.
    pub radius: f32,
    /// Uniform hash from which every random property of the strand derives. On the GPU, strands of one guide share the
    /// upper half, which provides the variation between locks.
    pub seed: u32,
    /// Color at the root from the groom file, see [`pack_color`]; 0 for none.
    pub root_color: u32,
    /// Color at the tip from the groom file; 0 for none. Without it, the color of the material.
    pub tip_color: u32,
}

impl Strand {
    /// Returns the linear color at each of `count` vertices, or `None` if the groom file has no color. The shaders of
    /// `tresses` blend alike (`light/shading.wesl`).
    pub fn colors(&self, count: usize) -> Option<impl Iterator<Item = Vec3> + use<>> {
        let root = unpack_color(self.root_color)?;
        let tip = unpack_color(self.tip_color).unwrap_or(root);
        let blend = move |t: f32| root.lerp(tip, t * t * (3.0 - 2.0 * t));
        Some((0..count).map(move |k| blend(k as f32 / (count - 1).max(1) as f32)))
    }
}

/// Returns the linear color that [`pack_color`] packed, or `None` for 0.
pub fn unpack_color(packed: u32) -> Option<Vec3> {
    let channel = |shift: u32| ((packed >> shift & 255) as f32 / 255.0).powi(2);
    (packed != 0).then(|| Vec3::new(channel(0), channel(8), channel(16)))
}

/// Packs a linear color, each channel clamped to 0..=1, with the square root as transfer curve. The top byte is 255, so
/// no color packs to 0.
pub fn pack_color(linear: Vec3) -> u32 {
    let channel = |v: f32| (v.clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u32;
    channel(linear.x) | channel(linear.y) << 8 | channel(linear.z) << 16 | 255 << 24
}
