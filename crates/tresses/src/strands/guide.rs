//! Guides: the simulated strands.

use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Vec3, Vec4};
use half::f16;

/// Bit of [`Guide::flags`]: the last vertex follows the head, as the root does.
pub const TIP_PINNED: u32 = 1;

/// Per-guide properties.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Guide {
    /// Rest length, meters.
    pub length: f32,
    /// Multiplier of the stiffness parameters, from the scalp map; 1 for no change.
    pub stiffness: f32,
    /// Number of drawn strands that the guide represents; its weight in the density grid.
    pub strands: f32,
    /// [`TIP_PINNED`]; the bits from the eighth on hold the guide of this rank in the order of levels of detail, if
    /// there is one.
    pub flags: u32,
    /// Lowest corner of the rest vertices, groom space, meters.
    pub origin: Vec3,
    /// Edge of the cube around the rest vertices, meters.
    pub extent: f32,
}

/// Rest position and clearance of a guide vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GuideRest {
    /// Position in groom space (the head's own frame), meters.
    pub position: Vec3,
    /// Distance from obstacles below which the vertex is pushed out, meters. At most the vertex's distance at rest, so
    /// that hair that starts in the skin is not pulled out of it.
    pub contact: f32,
}

/// The rest shape around a guide vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GuideShape {
    /// Rest value of the second difference `p[i-1] - 2 p[i] + p[i+1]`, meters, in groom space; rotated by the guide's
    /// frame before use.
    pub curvature: Vec3,
    /// Rest length of the edge from this vertex to the next, meters; 0 for the last.
    pub length: f32,
}

/// Largest deviation of a bend's rest value from the rest pose, as a fraction of the edge after it (a chord of about 40
/// degrees).
pub const MAX_GIVE: f32 = 0.7;
/// Largest deviation of an edge's rest length from its length in the rest pose, as a fraction of the latter.
pub const MAX_SHORTER: f32 = 0.05;

/// [`GuideRest`] and [`GuideShape`] of a vertex in GPU layout: the position as fractions of the guide's cube, the shape
/// as its deviation from the rest pose.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct PackedGuide {
    /// `x | y << 16` of the position.
    pub xy: u32,
    /// `z | contact << 16`; the contact is a half float, rounded down.
    pub z_contact: u32,
    /// `x | y << 16` of the bend's deviation, signed fractions of [`MAX_GIVE`] of the edge after it.
    pub give_xy: u32,
    /// `z` of that deviation, and the shortening of the edge as a fraction of [`MAX_SHORTER`].
    pub give_z_shorter: u32,
}

/// Quantizes a signed fraction to 16 bits.
fn signed(v: f32) -> i32 {
    (v.clamp(-1.0, 1.0) * 32_767.0).round() as i32
}

/// Rounds a bend's deviation `give` (meters) and an edge's shortening (meters) as packing does, for an edge of length
/// `edge`.
pub(crate) fn rounded_give(give: Vec3, shorter: f32, edge: f32) -> (Vec3, f32) {
    let edge = edge.max(1e-9);
    let round = |v: f32, max: f32| signed(v / (max * edge)) as f32 / 32_767.0 * max * edge;
    (give.map(|v| round(v, MAX_GIVE)), round(shorter, MAX_SHORTER))
}

impl PackedGuide {
    /// Packs the vertex at `rest`. Its bend deviates by `give` meters, and its edge of `edge` meters is shortened by
    /// `shorter` meters.
    pub fn pack(rest: &GuideRest, give: Vec3, shorter: f32, edge: f32, guide: &Guide) -> Self {
        let fractions = (rest.position - guide.origin) / guide.extent.max(1e-12);
        let quantized = (fractions.clamp(Vec3::ZERO, Vec3::ONE) * 65_535.0).round().as_uvec3();
        let near = f16::from_f32(rest.contact);
        // Rounded down, so that the rest pose has no contacts.
        let contact = if near.to_f32() <= rest.contact {
            near.to_bits()
        } else if near.is_sign_negative() {
            near.to_bits() + 1
        } else {
            near.to_bits().checked_sub(1).unwrap_or(0x8001)
        };
        let edge = edge.max(1e-9);
        let word = |a: i32, b: i32| u32::from(a as u16) | u32::from(b as u16) << 16;
        let give = give / (MAX_GIVE * edge);
        Self {
            xy: quantized.x | quantized.y << 16,
            z_contact: quantized.z | u32::from(contact) << 16,
            give_xy: word(signed(give.x), signed(give.y)),
            give_z_shorter: word(signed(give.z), signed(shorter / (MAX_SHORTER * edge))),
        }
    }

    /// Returns rest position and clearance.
    pub fn rest(&self, guide: &Guide) -> GuideRest {
        let fraction = |v: u32| (v & 0xffff) as f32 / 65_535.0;
        let fractions = Vec3::new(fraction(self.xy), fraction(self.xy >> 16), fraction(self.z_contact));
        let contact = f16::from_bits((self.z_contact >> 16) as u16).to_f32();
        GuideRest { position: guide.origin + fractions * guide.extent, contact }
    }
}

/// Packs a velocity in 8 bytes: three signed 19-bit fractions with a shared exponent. The error is at most 2⁻¹⁸ of the
/// largest component.
#[cfg(test)]
pub fn pack_velocity(v: Vec3) -> [u32; 2] {
    let (q, e) = shared(v, [90, 217], 181, 18);
    let [x, y, z] = (q & 0x7_ffff).as_uvec3().to_array();
    [x | y << 19, y >> 13 | z << 6 | e << 25]
}

/// Unpacks the result of `pack_velocity`, m/s.
pub fn unpack_velocity([a, b]: [u32; 2]) -> Vec3 {
    let part = |bits: u32| ((bits << 13) as i32 >> 13) as f32;
    let unit = f32::from_bits(((b >> 25) + 73) << 23);
    Vec3::new(part(a), part(a >> 19 | b << 13), part(b >> 6)) * unit
}

/// Packs a short displacement, meters, in 4 bytes: three signed 9-bit fractions with a shared exponent. 0 is no
/// displacement.
pub fn pack_lag(displacement: Vec3) -> u32 {
    let (q, e) = shared(displacement, [106, 137], 155, 8);
    let [x, y, z] = (q & 0x1ff).as_uvec3().to_array();
    x | y << 9 | z << 18 | e << 27
}

/// Returns `v` as integers of `bits` bits plus sign, and their shared exponent, counted from 0.
fn shared(v: Vec3, [min_exponent, max_exponent]: [u32; 2], inverse: u32, bits: u32) -> (IVec3, u32) {
    let e = (v.abs().max_element().to_bits() >> 23).clamp(min_exponent, max_exponent) - min_exponent;
    let limit = ((1 << bits) - 1) as f32;
    let q = v * f32::from_bits((inverse - e) << 23);
    (q.map(|v| v.round_ties_even().clamp(-limit, limit)).as_ivec3(), e)
}

/// A point of a tessellated guide: the B-spline evaluated at equal parameter steps. Two words of 16 bytes, because
/// drivers load such a word as fast as a number.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GuideSample {
    /// Position in world space, meters (xyz), and x of the rest position in groom space (w).
    pub position_rest_x: Vec4,
    /// Rotation of this sample's neighborhood from groom space at rest to the world: the head's rotation at the root,
    /// then minimal rotations from edge to edge (parallel transport). A quaternion of four signed 16-bit fractions;
    /// then the bits of y and z of the rest position.
    pub rotation_rest_yz: [u32; 4],
}

impl GuideSample {
    /// Returns a sample at rest at `rest` (groom space, meters), in the head's frame.
    pub fn at_rest(rest: Vec3) -> Self {
        Self {
            position_rest_x: rest.extend(rest.x),
            rotation_rest_yz: [0, 0x7fff_0000, rest.y.to_bits(), rest.z.to_bits()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unpacks the result of [`pack_lag`], meters.
    fn unpack_lag(packed: u32) -> Vec3 {
        let part = |bits: u32| ((bits << 23) as i32 >> 23) as f32;
        let unit = f32::from_bits(((packed >> 27) + 99) << 23);
        Vec3::new(part(packed), part(packed >> 9), part(packed >> 18)) * unit
    }

    #[test]
    fn motions_survive_packing() {
        for i in 0..2000 {
            let random = |k: u32| crate::math::hash::pcg(i * 3 + k) as f32 / u32::MAX as f32 * 2.0 - 1.0;
            let size = 10f32.powf(random(7) * 4.0 - 1.5);
            let v = Vec3::new(random(0), random(1), random(2)) * size;
            let most = v.abs().max_element();
            let off = (unpack_velocity(pack_velocity(v)) - v).abs().max_element();
            assert!(off <= most * 2.0f32.powi(-17) * 0.5 + 1e-16, "{v} {off}");
            let off = (unpack_lag(pack_lag(v)) - v).abs().max_element();
            assert!(off <= most / 128.0 && off <= 4e-9 + most / 250.0, "{v} {off}");
        }
        assert_eq!((pack_velocity(Vec3::ZERO), pack_lag(Vec3::ZERO)), ([0; 2], 0));
        assert_eq!((unpack_velocity([0; 2]), unpack_lag(0)), (Vec3::ZERO, Vec3::ZERO));
    }

    #[test]
    fn guide_vertices_survive_packing() {
        let guide = Guide { origin: Vec3::new(-0.1, 1.5, 0.02), extent: 0.3, ..Guide::default() };
        for contact in [1.5e-3, 1.234e-3, 0.0, -1e-5, -0.01234] {
            let rest = GuideRest { position: Vec3::new(0.05, 1.61, 0.17), contact };
            let back = PackedGuide::pack(&rest, Vec3::ZERO, 0.0, 0.01, &guide).rest(&guide);
            assert!(back.position.distance(rest.position) < 4.1e-6, "{back:?}");
            let less = contact - back.contact;
            assert!(less >= 0.0 && less <= 1e-3 * contact.abs() + 6e-8, "{back:?}");
        }
    }
}
