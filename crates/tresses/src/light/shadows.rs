//! How shadows are made: the method, how soft, how dense.

use crate::constants::SHADOW_BLOCK;

/// How hair before other hair is counted. Every method answers with the mean number of fibres
/// between a light and a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum ShadowMethod {
    /// As if hair were solid: the share of a disk of taps that sees no hair before the point
    /// (percentage-closer filtering). Hair in the second row is black.
    Opaque,
    /// Each tap counts the fibres on the way behind the hair nearest the light, as if all hair were
    /// equally dense (Halen's absorption-weighted filter): [`Shadows::density`].
    Absorption,
    /// Deep opacity maps (Yuksel and Keyser 2008): fibres are counted where they are, in layers that
    /// follow the hair's front.
    #[default]
    DeepOpacity,
}

/// How shadows are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadows {
    /// How hair is counted.
    pub method: ShadowMethod,
    /// Radius of the disk over which the shadow on hair is averaged, metres. Deep opacity maps are
    /// as fine as that, but a texel is no smaller than three of the depth maps'.
    pub hair_radius: f32,
    /// Radius over which the shadow of the body on itself is averaged, metres.
    pub body_radius: f32,
    /// Fibres that light meets per metre of its way through hair, 1/m: what
    /// [`ShadowMethod::Absorption`] supposes.
    pub density: f32,
    /// The share of the light that one fibre takes from the body behind it.
    pub body_opacity: f32,
    /// How far a surface is lifted towards the light before it is compared, metres.
    pub bias: f32,
    /// Whether the maps are asked for every pixel of the hair, not for every strand vertex; only where
    /// hair is shaded per pixel ([`super::ShadingRate::PerPixel`]).
    pub per_pixel: bool,
}

impl Default for Shadows {
    fn default() -> Self {
        Self {
            method: ShadowMethod::default(),
            hair_radius: 0.003,
            body_radius: 0.004,
            density: 400.0,
            body_opacity: 0.6,
            bias: 0.0015,
            per_pixel: false,
        }
    }
}

impl Shadows {
    /// Texels of a depth map along the edge of one of a deep opacity map, where a depth map's texel
    /// is `texel` metres. A deep opacity map is read through a spline over three by three texels; a
    /// texel of 0.866 radii makes that as wide as the disk.
    pub(crate) fn deep_texels(&self, texel: f32) -> u32 {
        ((0.866 * self.hair_radius / texel).round() as u32).clamp(DEEP_FINEST, 64)
    }

    /// Texels between the places of a shadow map that moves with the hair: whole texels of whatever
    /// is read from it.
    pub(crate) fn snap(&self, texel: f32) -> u32 {
        match self.method {
            ShadowMethod::DeepOpacity => self.deep_texels(texel),
            _ => SHADOW_BLOCK,
        }
    }
}

/// The fewest texels of a depth map along the edge of a deep opacity map's texel.
pub(crate) const DEEP_FINEST: u32 = 3;
