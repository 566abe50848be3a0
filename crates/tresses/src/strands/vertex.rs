//! Vertices of the drawn strands: 16 bytes each, written once per frame by `interpolate` and read by every later pass.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

/// A vertex of a drawn strand.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct StrandVertex {
    /// Position in world space, meters.
    pub position: Vec3,
    /// Tangent and radius, see [`pack_tangent`].
    pub tangent: u32,
}

/// Packs a unit tangent (octahedral, 12 bits per axis, error below 0.06 degrees) and the radius as a fraction of
/// [`super::Strand::radius`] (8 bits).
pub fn pack_tangent(tangent: Vec3, radius: f32) -> u32 {
    let n = tangent / (tangent.x.abs() + tangent.y.abs() + tangent.z.abs()).max(1e-20);
    let folded = if n.z >= 0.0 {
        Vec2::new(n.x, n.y)
    } else {
        Vec2::new((1.0 - n.y.abs()) * 1f32.copysign(n.x), (1.0 - n.x.abs()) * 1f32.copysign(n.y))
    };
    let axis = |v: f32| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 4095.0 + 0.5) as u32;
    axis(folded.x) | axis(folded.y) << 12 | ((radius.clamp(0.0, 1.0) * 255.0 + 0.5) as u32) << 24
}

/// Unpacks the unit tangent and the radius fraction packed by [`pack_tangent`].
pub fn unpack_tangent(packed: u32) -> (Vec3, f32) {
    let axis = |v: u32| (v & 4095) as f32 / 4095.0 * 2.0 - 1.0;
    let f = Vec2::new(axis(packed), axis(packed >> 12));
    let mut n = Vec3::new(f.x, f.y, 1.0 - f.x.abs() - f.y.abs());
    let fold = (-n.z).max(0.0);
    n.x -= fold.copysign(n.x);
    n.y -= fold.copysign(n.y);
    (n.normalize(), (packed >> 24) as f32 / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_survive_packing() {
        for i in 0..500 {
            let angle = i as f32 * 2.399_963;
            let z = 1.0 - (i as f32 + 0.5) / 250.0;
            let r = (1.0 - z * z).max(0.0).sqrt();
            let tangent = Vec3::new(r * angle.cos(), r * angle.sin(), z);
            let (back, radius) = unpack_tangent(pack_tangent(tangent, 0.5));
            assert!(back.cross(tangent).length() < 0.06f32.to_radians(), "{tangent} {back}");
            assert!((radius - 0.5).abs() < 0.003);
        }
    }
}
