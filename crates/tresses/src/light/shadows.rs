//! Shadow settings: softness, density.

use crate::renderer::ShadowMethod;

/// Shadow settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadows {
    /// Whether lights cast shadows. Otherwise every light reaches every point.
    pub is_enabled: bool,
    /// Radius of the disk over which shadows on hair are averaged, meters. It sets the resolution of the hair maps. A
    /// texel of a deep opacity map is at least three texels of a depth map wide.
    pub hair_radius: f32,
    /// Radius over which the shadows of meshes on themselves are averaged, meters.
    pub body_radius: f32,
    /// Fibers that light hits per meter of its path through hair, 1/m. Used by [`ShadowMethod::Absorption`].
    pub density: f32,
    /// Weight of the shadow of hair on meshes. At 1, a fiber removes as much light from a mesh as from other hair.
    pub body_opacity: f32,
    /// Distance by which a surface is moved towards the light before the comparison, meters.
    pub bias: f32,
    /// Variation of light and shadow from strand to strand, where maps have only a mean: 0 for none, 1 as in real hair.
    /// Only for [`ShadingModel::Fiber`](crate::renderer::ShadingModel::Fiber).
    pub strand_by_strand: f32,
    /// Whether light from the sky and from meshes is propagated through the hair. Otherwise sky visibility is estimated
    /// from the zenith and the lights that are on, and meshes reflect no light.
    pub has_ambient: bool,
}

impl Default for Shadows {
    fn default() -> Self {
        Self {
            is_enabled: true,
            hair_radius: 0.003,
            body_radius: 0.004,
            density: 400.0,
            body_opacity: 1.0,
            bias: 0.0015,
            strand_by_strand: 1.0,
            has_ambient: true,
        }
    }
}

impl Shadows {
    /// Whether ambient light is computed. Without shadows there is no need: all of the sky arrives.
    pub(crate) fn computes_ambient(&self) -> bool {
        self.has_ambient && self.is_enabled
    }

    /// Returns the number of maps for `lights` lights that are on. The last map is the sky's. It exists only where sky
    /// visibility is estimated.
    pub(crate) fn map_count(&self, lights: usize) -> usize {
        lights + usize::from(!self.computes_ambient())
    }

    /// Returns the width of a texel of the hair maps, in texels of a depth map, which are `texel` meters wide. Hair
    /// maps are only as fine as their shadows are sharp, and a filter that reads all of their texels does not flicker.
    /// A spline over 3×3 texels reads deep opacity maps: texels of 0.866 radii make it as wide as the disk. A spline
    /// over 9×9 texels reads the depths of the nearest hair.
    pub(crate) fn hair_texels(&self, method: ShadowMethod, texel: f32) -> u32 {
        let texels = |radii: f32| (radii * self.hair_radius / texel).round() as u32;
        match method {
            ShadowMethod::DeepOpacity => texels(0.866).clamp(MIN_DEEP_OPACITY_TEXEL, 64),
            ShadowMethod::Opaque | ShadowMethod::Absorption => texels(0.333).clamp(1, 64),
        }
    }
}

/// Minimum width of a deep opacity map's texel, in texels of a depth map.
pub(crate) const MIN_DEEP_OPACITY_TEXEL: u32 = 3;
