//! What the parts of the light stage share: the bindings of everything that is drawn in light, and the parameters of a
//! frame.

use super::{Light, Sphere, map_view::MapView};
use crate::{gpu::Binding, renderer::ShadowMethod};
use std::f32::consts::PI;

/// Layout of `@group(0)` for everything that is drawn in light: camera, lights, depth maps of meshes, their comparison
/// sampler, hair maps, blocks of the hair maps, ambient light, its sampler, light without shadow maps.
pub(super) const FRAME: [Binding; 9] = [
    Binding::Uniform,
    Binding::Uniform,
    Binding::DepthArray,
    Binding::Comparison,
    Binding::Storage,
    Binding::Storage,
    Binding::Texture3d,
    Binding::Sampler,
    Binding::Texture3d,
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
    /// Lights with shadow maps.
    pub lights: Vec<Light>,
    /// Number of lights with a strand map.
    pub strands: usize,
    /// Limit on the deviation of shadow-casting meshes from the drawn ones, meters.
    pub stray: f32,
    /// Whether the frame computes ambient light.
    pub ambient: bool,
    /// Whether the frame has lights without shadow maps.
    pub has_unmapped: bool,
    /// Stride through the sample points of mesh surfaces.
    pub every: u32,
    /// Views into the maps.
    pub views: Vec<MapView>,
    /// Region that the maps cover.
    pub focus: Sphere,
}

impl FrameLight {
    /// Whether something within `other` may shadow something in the focus: it lies between the focus and a light.
    pub fn is_shadowed_by(&self, other: &Sphere) -> bool {
        let Sphere { center, radius } = self.focus;
        let reach = radius + other.radius;
        let offset = other.center - center;
        self.lights.iter().any(|light| match light.center() {
            None => {
                let along = offset.dot(light.irradiance_at(center).0);
                along > -reach && offset.length_squared() - along * along < reach * reach
            }
            Some(place) => {
                let [own, its] = [center, other.center].map(|center| center - place);
                let [far, near] = [own.length(), its.length()];
                // Half of the angle at which the light sees each of them.
                let angle = |radius: f32, away: f32| if away > radius { (radius / away).asin() } else { PI };
                near < far + reach && own.angle_between(its) < angle(radius, far) + angle(other.radius, near)
            }
        })
    }
}
