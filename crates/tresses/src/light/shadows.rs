//! Shadow settings: method, softness, density.

/// Method that counts the hair between a light and a point. The result of every method is a mean number of fibers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum ShadowMethod {
    /// Hair counts as solid: the fraction of 81 taps without hair in front of the point (percentage-closer filtering).
    /// Hair behind other hair is black.
    Opaque,
    /// Each tap counts fibers on the way behind the hair nearest the light, for hair of a uniform density
    /// ([`Shadows::density`]; Halen's absorption-weighted filter).
    Absorption,
    /// Deep opacity maps (Yuksel and Keyser 2008): layers that start at the first depth layer of the hair count the
    /// fibers where they are.
    #[default]
    DeepOpacity,
    /// No shadows: every light reaches every point. For comparisons, and for images that need no shadows.
    Off,
}

/// Shadow settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadows {
    /// Method that counts hair.
    pub method: ShadowMethod,
    /// Radius of the disk over which shadows on hair are averaged, meters. It sets the resolution of the hair maps. A
    /// texel of a deep opacity map is at least three texels of a depth map wide.
    pub hair_radius: f32,
    /// Radius over which the shadows of meshes on themselves are averaged, meters.
    pub body_radius: f32,
    /// Fibers that light hits per meter of its way through hair, 1/m. [`ShadowMethod::Absorption`] uses it.
    pub density: f32,
    /// Weight of the shadow of hair on meshes. At 1, a fiber removes as much light from a mesh as from other hair.
    pub body_opacity: f32,
    /// Distance by which a surface is moved towards the light before the comparison, meters.
    pub bias: f32,
    /// Variation of light and shadow from strand to strand, where maps have only a mean: 0 for none, 1 as in real hair.
    /// Only for [`super::ShadingModel::Fiber`].
    pub strand_by_strand: f32,
    /// Whether each pixel of the hair reads the maps, instead of each strand vertex. Only for hair that is shaded per
    /// pixel ([`super::ShadingRate::PerPixel`]).
    pub per_pixel: bool,
    /// Whether light from the sky and from meshes is propagated through the hair ([`super::ambient`]). Otherwise sky
    /// visibility is estimated from the zenith and the lights that are on, and meshes reflect no light.
    pub ambient: bool,
}

impl Default for Shadows {
    fn default() -> Self {
        Self {
            method: ShadowMethod::default(),
            hair_radius: 0.003,
            body_radius: 0.004,
            density: 400.0,
            body_opacity: 1.0,
            bias: 0.0015,
            strand_by_strand: 1.0,
            per_pixel: false,
            ambient: true,
        }
    }
}

impl Shadows {
    /// Whether ambient light is computed. Without shadows there is no need: all of the sky arrives.
    pub(crate) fn follows_ambient(&self) -> bool {
        self.ambient && self.method != ShadowMethod::Off
    }

    /// Returns the number of maps for `lights` lights that are on. The last map is the sky's. It exists only where sky
    /// visibility is estimated.
    pub(crate) fn maps(&self, lights: usize) -> usize {
        lights + usize::from(!self.follows_ambient())
    }

    /// Returns the edge of a texel of the hair maps in texels of a depth map, which are `texel` meters wide. Hair maps
    /// are only as fine as their shadows are sharp, and a filter that reads all of their texels does not flicker. A
    /// spline over 3×3 texels reads deep opacity maps: texels of 0.866 radii make it as wide as the disk. A spline over
    /// 9×9 texels reads the depths of the nearest hair.
    pub(crate) fn hair_texels(&self, texel: f32) -> u32 {
        let texels = |share: f32| (share * self.hair_radius / texel).round() as u32;
        match self.method {
            ShadowMethod::DeepOpacity | ShadowMethod::Off => texels(0.866).clamp(DEEP_FINEST, 64),
            ShadowMethod::Opaque | ShadowMethod::Absorption => texels(0.333).clamp(1, 64),
        }
    }
}

/// Minimum edge of a deep opacity map's texel, in texels of a depth map.
pub(crate) const DEEP_FINEST: u32 = 3;
