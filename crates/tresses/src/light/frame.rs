//! What the parts of the light stage share: the bindings of everything that is drawn in light, and the parameters of a
//! frame.

use super::{Sphere, lights::SHADOW_MAPS};
use crate::{gpu::Binding, renderer::ShadowMethod};
use glam::Mat4;

/// Layout of `@group(0)` for everything that is drawn in light: camera, lights, depth maps of meshes, their comparison
/// sampler, hair maps, blocks of the hair maps, ambient light, its sampler.
pub(super) const FRAME: [Binding; 8] = [
    Binding::Uniform,
    Binding::Uniform,
    Binding::DepthArray,
    Binding::Comparison,
    Binding::Storage,
    Binding::Storage,
    Binding::Texture3d,
    Binding::Sampler,
];

/// Layout of a groom's `@group(1)`: uniform, vertices, strands and shaded colors.
pub(super) const HAIR: [Binding; 4] =
    [Binding::Uniform, Binding::Storage, Binding::Storage, Binding::Storage];

/// Parameters of the light passes of a frame.
#[derive(Clone, Debug)]
pub(crate) struct FrameLight {
    /// Whether lights cast shadows.
    pub casts: bool,
    pub method: ShadowMethod,
    /// Number of shadow maps.
    pub maps: usize,
    /// Edge of a texel of the hair maps, in texels of a depth map.
    pub across: u32,
    /// Ids of the lights with shadow maps.
    pub ids: Vec<u32>,
    /// Number of lights with a strand map.
    pub strands: usize,
    /// Limit on the deviation of shadow-casting meshes from the drawn ones, meters.
    pub stray: f32,
    /// Whether the frame computes ambient light.
    pub ambient: bool,
    /// Stride through the sample points of mesh surfaces.
    pub every: u32,
    /// World to clip space of each map.
    pub matrices: [Mat4; SHADOW_MAPS],
    /// Depth of the maps, meters.
    pub range: f32,
    /// Region that the maps cover.
    pub focus: Sphere,
}
