//! Guides: the strands that are simulated.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

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
    /// [`TIP_PINNED`].
    pub flags: u32,
}

/// Where a guide vertex rests.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GuideRest {
    /// Groom space (the head's own frame), metres.
    pub position: Vec3,
    /// Distance from the obstacles below which the vertex is pushed out, metres. Never more than
    /// the vertex has at rest, so that a hair that starts in the skin is not torn out of it.
    pub contact: f32,
}

/// The rest shape around a guide vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GuideShape {
    /// Rest value of the second difference `p[i-1] - 2 p[i] + p[i+1]`, metres, in groom space;
    /// turned by the guide's frame before use.
    pub curvature: Vec3,
    /// Rest length of the edge from this vertex to the next, metres; 0 for the last.
    pub length: f32,
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
