//! Guides: the strands that are simulated.

use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Vec3, Vec4};
use half::f16;

/// Bit of [`Guide::flags`]: the last vertex follows the head, as the root does.
pub const TIP_PINNED: u32 = 1;

/// What is known of one guide as a whole.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Guide {
    /// Rest length, metres.
    pub length: f32,
    /// Multiplier of the stiffness parameters, from the scalp map; 1 is as the parameters say.
    pub stiffness: f32,
    /// How many drawn strands it stands for; weighs it in the density grid.
    pub strands: f32,
    /// [`TIP_PINNED`], and from the eighth bit on which guide has this one's place in the order of levels of detail, once
    /// there is one.
    pub flags: u32,
    /// Smallest corner of the rest vertices, groom space, metres.
    pub origin: Vec3,
    /// Edge of the cube that holds them, metres.
    pub extent: f32,
}

/// Where a guide vertex rests.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GuideRest {
    /// Groom space (the head's own frame), metres.
    pub position: Vec3,
    /// Distance from the obstacles below which the vertex is pushed out, metres. Never more than
    /// the vertex has at rest, so that a hair that starts in the skin is not torn out of it.
    pub contact: f32,
}

/// The rest shape around a guide vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GuideShape {
    /// Rest value of the second difference `p[i-1] - 2 p[i] + p[i+1]`, metres, in groom space;
    /// turned by the guide's frame before use.
    pub curvature: Vec3,
    /// Rest length of the edge from this vertex to the next, metres; 0 for the last.
    pub length: f32,
}

/// How far the rest value of a bend may be from the rest pose, as a fraction of the edge after it (a chord of about
/// 40 degrees).
pub const MOST_GIVE: f32 = 0.7;
/// By how much an edge's rest length may differ from its length in the rest pose, as a fraction of that.
pub const MOST_SHORTER: f32 = 0.05;

/// [`GuideRest`] and [`GuideShape`] of a vertex as the GPU has them: the position as fractions of the guide's cube, the
/// shape as what it gives way from the rest pose.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct PackedGuide {
    /// `x | y << 16` of the position.
    pub xy: u32,
    /// `z | contact << 16`, the contact a half float that is never more than it was.
    pub z_contact: u32,
    /// `x | y << 16` of what the bend gives, signed fractions of [`MOST_GIVE`] of the edge after it.
    pub give_xy: u32,
    /// `z` of that, and by which fraction of [`MOST_SHORTER`] the edge is shorter.
    pub give_z_shorter: u32,
}

/// A signed fraction in 16 bits.
fn signed(v: f32) -> i32 {
    (v.clamp(-1.0, 1.0) * 32_767.0).round() as i32
}

/// The fractions of an edge of length `edge` that a bend gives (metres) and that the edge is shorter (metres), as they
/// survive packing.
pub(crate) fn rounded_give(give: Vec3, shorter: f32, edge: f32) -> (Vec3, f32) {
    let edge = edge.max(1e-9);
    let round = |v: f32, most: f32| signed(v / (most * edge)) as f32 / 32_767.0 * most * edge;
    (give.map(|v| round(v, MOST_GIVE)), round(shorter, MOST_SHORTER))
}

impl PackedGuide {
    /// The vertex at `rest`, whose bend gives `give` metres and whose edge, `edge` metres long, is `shorter` by so
    /// many.
    pub fn pack(rest: &GuideRest, give: Vec3, shorter: f32, edge: f32, guide: &Guide) -> Self {
        let places = (rest.position - guide.origin) / guide.extent.max(1e-12);
        let places = (places.clamp(Vec3::ZERO, Vec3::ONE) * 65_535.0).round().as_uvec3();
        let near = f16::from_f32(rest.contact);
        // Rounded down: rest must not become a contact.
        let contact = if near.to_f32() <= rest.contact {
            near.to_bits()
        } else if near.is_sign_negative() {
            near.to_bits() + 1
        } else {
            near.to_bits().checked_sub(1).unwrap_or(0x8001)
        };
        let edge = edge.max(1e-9);
        let word = |a: i32, b: i32| u32::from(a as u16) | u32::from(b as u16) << 16;
        let give = give / (MOST_GIVE * edge);
        Self {
            xy: places.x | places.y << 16,
            z_contact: places.z | u32::from(contact) << 16,
            give_xy: word(signed(give.x), signed(give.y)),
            give_z_shorter: word(signed(give.z), signed(shorter / (MOST_SHORTER * edge))),
        }
    }

    /// Where the vertex rests.
    pub fn rest(&self, guide: &Guide) -> GuideRest {
        let fraction = |v: u32| (v & 0xffff) as f32 / 65_535.0;
        let places = Vec3::new(fraction(self.xy), fraction(self.xy >> 16), fraction(self.z_contact));
        let contact = f16::from_bits((self.z_contact >> 16) as u16).to_f32();
        GuideRest { position: guide.origin + places * guide.extent, contact }
    }
}

/// A velocity in 8 bytes: three signed fractions of 19 bits with one exponent, so that the error is 2⁻¹⁹ of the largest
/// component.
pub fn pack_velocity(v: Vec3) -> [u32; 2] {
    let (q, e) = shared(v, [90, 217], 181, 18);
    let [x, y, z] = (q & 0x7_ffff).as_uvec3().to_array();
    [x | y << 19, y >> 13 | z << 6 | e << 25]
}

/// The velocity packed by [`pack_velocity`], m/s.
pub fn unpack_velocity([a, b]: [u32; 2]) -> Vec3 {
    let part = |bits: u32| ((bits << 13) as i32 >> 13) as f32;
    let unit = f32::from_bits(((b >> 25) + 73) << 23);
    Vec3::new(part(a), part(a >> 19 | b << 13), part(b >> 6)) * unit
}

/// A short way in 4 bytes, metres: three signed fractions of 9 bits with one exponent. 0 is none.
pub fn pack_lag(way: Vec3) -> u32 {
    let (q, e) = shared(way, [106, 137], 155, 8);
    let [x, y, z] = (q & 0x1ff).as_uvec3().to_array();
    x | y << 9 | z << 18 | e << 27
}

/// The way packed by [`pack_lag`].
pub fn unpack_lag(packed: u32) -> Vec3 {
    let part = |bits: u32| ((bits << 23) as i32 >> 23) as f32;
    let unit = f32::from_bits(((packed >> 27) + 99) << 23);
    Vec3::new(part(packed), part(packed >> 9), part(packed >> 18)) * unit
}

/// `v` as integers of so many `bits` besides the sign, and the exponent that they share, from 0.
fn shared(v: Vec3, [least, most]: [u32; 2], inverse: u32, bits: u32) -> (IVec3, u32) {
    let e = (v.abs().max_element().to_bits() >> 23).clamp(least, most) - least;
    let limit = ((1 << bits) - 1) as f32;
    let q = v * f32::from_bits((inverse - e) << 23);
    (q.map(|v| v.round_ties_even().clamp(-limit, limit)).as_ivec3(), e)
}

/// A point of a tessellated guide: the B-spline evaluated at equal parameter steps. Two words of 16 bytes, since
/// drivers load such a word as fast as a number.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GuideSample {
    /// World space, metres (xyz), and where it rests in groom space: x.
    pub place: Vec4,
    /// The rotation that carries the neighbourhood of this sample from groom space at rest to the
    /// world: the head's rotation at the root, then minimal rotations from edge to edge
    /// (parallel transport). A quaternion, four signed fractions of 16 bits; then the bits of y and z of where it
    /// rests.
    pub turn: [u32; 4],
}

impl GuideSample {
    /// At rest at `rest` (groom space, metres), the head in its own frame.
    pub fn at_rest(rest: Vec3) -> Self {
        Self { place: rest.extend(rest.x), turn: [0, 0x7fff_0000, rest.y.to_bits(), rest.z.to_bits()] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_guide_vertex_survives_packing() {
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
