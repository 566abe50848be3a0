//! How shadows are made: the method, how soft, how dense.

/// How hair before other hair is counted. Every method answers with the mean number of fibres
/// between a light and a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum ShadowMethod {
    /// As if hair were solid: the share of 81 taps that see no hair before the point
    /// (percentage-closer filtering). Hair in the second row is black.
    Opaque,
    /// Each tap counts the fibres on the way behind the hair nearest the light, as if all hair were
    /// equally dense (Halen's absorption-weighted filter): [`Shadows::density`].
    Absorption,
    /// Deep opacity maps (Yuksel and Keyser 2008): fibres are counted where they are, in layers that
    /// follow the hair's front.
    #[default]
    DeepOpacity,
    /// None: every light reaches every point. To compare with, and for pictures that need no shadows.
    Off,
}

/// How shadows are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadows {
    /// How hair is counted.
    pub method: ShadowMethod,
    /// Radius of the disk over which the shadow on hair is averaged, metres. The hair's maps are as
    /// fine as that takes; a texel of a deep opacity map is no smaller than three of a depth map.
    pub hair_radius: f32,
    /// Radius over which the shadow of the body on itself is averaged, metres.
    pub body_radius: f32,
    /// Fibres that light meets per metre of its way through hair, 1/m: what
    /// [`ShadowMethod::Absorption`] supposes.
    pub density: f32,
    /// The weight of the hair before the body: at 1, a fibre takes as much from the body behind it as from
    /// other hair.
    pub body_opacity: f32,
    /// How far a surface is lifted towards the light before it is compared, metres.
    pub bias: f32,
    /// How much strands are in light or in shade one by one, of which the maps know the mean alone: 0 not at all, 1
    /// as hair is. [`super::ShadingModel::Fiber`] has it.
    pub strand_by_strand: f32,
    /// Whether the maps are asked for every pixel of the hair, not for every strand vertex; only where
    /// hair is shaded per pixel ([`super::ShadingRate::PerPixel`]).
    pub per_pixel: bool,
    /// Whether light from the sky and from the body is followed through the hair
    /// ([`super::ambient`]). Otherwise the sky's openness is guessed from the zenith and the lights that
    /// are on, and bodies throw no light.
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
    /// Whether ambient light is computed: where nothing casts shadows all of the sky arrives.
    pub(crate) fn follows_ambient(&self) -> bool {
        self.ambient && self.method != ShadowMethod::Off
    }

    /// How many maps `lights` that are on take. The sky's is the last: only a guess of its openness asks for it.
    pub(crate) fn maps(&self, lights: usize) -> usize {
        lights + usize::from(!self.follows_ambient())
    }

    /// Texels of a depth map along the edge of a texel of the hair's, where a depth map's is `texel`
    /// metres: the hair's maps are only as fine as its shadow is soft, and a filter that meets all of
    /// their texels leaves nothing to flicker. Deep opacity maps are read through a spline over three by
    /// three texels: 0.866 radii make that as wide as the disk. The depths of the nearest hair are read
    /// through one over nine by nine.
    pub(crate) fn hair_texels(&self, texel: f32) -> u32 {
        let texels = |share: f32| (share * self.hair_radius / texel).round() as u32;
        match self.method {
            ShadowMethod::DeepOpacity | ShadowMethod::Off => texels(0.866).clamp(DEEP_FINEST, 64),
            ShadowMethod::Opaque | ShadowMethod::Absorption => texels(0.333).clamp(1, 64),
        }
    }
}

/// The fewest texels of a depth map along the edge of a deep opacity map's texel.
pub(crate) const DEEP_FINEST: u32 = 3;
