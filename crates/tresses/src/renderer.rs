//! The renderers of hair, each with the options that it has.
//!
//! | | coverage of strands thinner than a pixel | shading | shadows between strands |
//! |---|---|---|---|
//! | [`Tiles`](Renderer::Tiles) | exact; all strands blended in order by compute shaders | fiber or Kajiya–Kay, per vertex | deep opacity maps |
//! | [`Masks`](Renderer::Masks) | stochastic: each strand covers a subset of the samples | fiber or Kajiya–Kay, per vertex | deep opacity maps |
//! | [`Classic`](Renderer::Classic) | alpha to coverage, or depth peeling | Kajiya–Kay, per vertex or per pixel | opaque, absorption or deep opacity maps |
//!
//! `docs/validation/coverage.md` has figures and images of each.

use crate::{
    Error, Result,
    constants::{LIGHT_GROUP, MAX_LIGHTS},
};

/// How a view draws hair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Renderer {
    /// A compute rasterizer: the exact covered fraction of a pixel becomes alpha, and all
    /// strands are blended from front to back. Only visible segments are shaded.
    Tiles(TileOptions),
    /// Strips whose samples are masked. A strip is drawn at least [`min_width`](crate::light::HairMaterial::min_width)
    /// pixels wide and covers only the fraction of the samples that corresponds to its true width; each strand covers a
    /// different set. One pass, no sorting, correct on average however many strands overlap. A pixel is the mean of the
    /// samples in a disc, which is wider than the pixel if it has few samples (`Footprint`); otherwise moving hair
    /// would shimmer.
    Masks(MaskOptions),
    /// The renderer of Tariq and Bavoil (2008), in Kajiya–Kay shading.
    Classic(ClassicOptions),
}

/// Options of [`Renderer::Tiles`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TileOptions {
    /// Shading model.
    pub shading: ShadingModel,
    /// Samples per pixel of bodies: 1, 4, 8 or 16, as far as the adapter allows. Hair has no samples.
    pub sample_count: u32,
}

/// Options of [`Renderer::Masks`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaskOptions {
    /// Shading model.
    pub shading: ShadingModel,
    /// Samples per pixel: 1, 4, 8 or 16, as far as the adapter allows. With 1, coverage is a probability: a strand ends
    /// where it becomes too thin for its own threshold.
    pub sample_count: u32,
}

/// Options of [`Renderer::Classic`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClassicOptions {
    /// How strands cover pixels that they are thinner than.
    pub coverage: ClassicCoverage,
    /// Where hair is shaded.
    pub rate: ShadingRate,
    /// Method that counts the hair between a light and a point.
    pub shadows: ShadowMethod,
}

/// How [`Renderer::Classic`] draws strands thinner than a pixel. The exact covered fraction of the pixel becomes alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClassicCoverage {
    /// The adapter turns alpha into samples
    /// ([alpha to coverage](wgpu::MultisampleState::alpha_to_coverage_enabled)). One pass writes depth; a second one
    /// writes color where depth is equal. Adapters map equal alpha to equal samples: overlapping thin strands hide each
    /// other, and dense thin hair covers too little.
    AlphaToCoverage {
        /// Samples per pixel: 4, 8 or 16, as far as the adapter allows.
        samples: u32,
    },
    /// Strands are blended from front to back, one layer per pass over the geometry (Everitt 2001, "Interactive
    /// order-independent transparency"; Bavoil and Myers 2008). One sample per pixel.
    DepthPeeling {
        /// Layers blended in order, 1 to [`MAX_LAYERS`](Self::MAX_LAYERS). The hair behind them is blended by depth, at
        /// eight nodes.
        layers: u32,
    },
}

/// Shading model of hair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ShadingModel {
    /// Kajiya and Kay's fiber with two highlights, set by eye. Colors are albedos.
    KajiyaKay,
    /// Physical model: fibers refract, absorb and reflect light, and scatter it among each other. Colors follow from
    /// melanin (`fiber`).
    #[default]
    Fiber,
}

/// Rate at which hair is shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ShadingRate {
    /// Per pixel, with noise finer than the strand vertices. Shadows are still evaluated per vertex.
    PerPixel,
    /// Per strand vertex, in a compute kernel. The cost does not depend on image size or samples per pixel.
    #[default]
    PerVertex,
}

/// Method that counts the hair between a light and a point. The result of every method is a mean number of fibers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ShadowMethod {
    /// Hair counts as solid: the fraction of 81 taps without hair in front of the point (percentage-closer filtering).
    /// Hair behind other hair is black.
    Opaque,
    /// Each tap counts fibers on the way behind the hair nearest the light, for hair of a uniform density
    /// ([`Shadows::density`](crate::light::Shadows::density); Halen's absorption-weighted filter).
    Absorption,
    /// Deep opacity maps (Yuksel and Keyser 2008): layers that start at the first depth layer of the hair count the
    /// fibers where they are.
    #[default]
    DeepOpacity,
}

impl Default for Renderer {
    fn default() -> Self {
        Self::Tiles(TileOptions::default())
    }
}

impl Default for TileOptions {
    fn default() -> Self {
        Self { shading: ShadingModel::default(), sample_count: 4 }
    }
}

impl Default for MaskOptions {
    fn default() -> Self {
        Self { shading: ShadingModel::default(), sample_count: 4 }
    }
}

impl Default for ClassicOptions {
    /// Four peeled layers, shading per vertex, deep opacity maps.
    fn default() -> Self {
        Self {
            coverage: ClassicCoverage::PEELING,
            rate: ShadingRate::default(),
            shadows: ShadowMethod::default(),
        }
    }
}

impl ClassicCoverage {
    /// The largest number of layers.
    pub const MAX_LAYERS: u32 = 16;

    /// Depth peeling with four layers.
    pub const PEELING: Self = Self::DepthPeeling { layers: 4 };
}

impl Renderer {
    /// Returns [`Tiles`](Self::Tiles) with `samples` per pixel of bodies.
    pub const fn tiles(samples: u32) -> Self {
        Self::Tiles(TileOptions { shading: ShadingModel::Fiber, sample_count: samples })
    }

    /// Returns [`Masks`](Self::Masks) with `samples` per pixel.
    pub const fn masks(samples: u32) -> Self {
        Self::Masks(MaskOptions { shading: ShadingModel::Fiber, sample_count: samples })
    }

    /// Returns [`Classic`](Self::Classic) with depth peeling, shading per vertex and deep opacity maps.
    pub const fn peeling(layers: u32) -> Self {
        Self::classic(ClassicCoverage::DepthPeeling { layers })
    }

    /// Returns [`Classic`](Self::Classic) with alpha to coverage, shading per vertex and deep opacity maps.
    pub const fn alpha_to_coverage(samples: u32) -> Self {
        Self::classic(ClassicCoverage::AlphaToCoverage { samples })
    }

    const fn classic(coverage: ClassicCoverage) -> Self {
        let (rate, shadows) = (ShadingRate::PerVertex, ShadowMethod::DeepOpacity);
        Self::Classic(ClassicOptions { coverage, rate, shadows })
    }

    /// Returns this renderer with `model`, which the classic renderer ignores.
    #[must_use]
    pub const fn with_shading(self, model: ShadingModel) -> Self {
        match self {
            Self::Tiles(options) => Self::Tiles(TileOptions { shading: model, ..options }),
            Self::Masks(options) => Self::Masks(MaskOptions { shading: model, ..options }),
            Self::Classic(_) => self,
        }
    }

    /// Checks sample and layer counts.
    ///
    /// # Errors
    /// [`Error::Parameter`] if alpha to coverage has one sample, or the number of layers is out of range.
    pub fn check(self) -> Result<()> {
        let Self::Classic(classic) = self else { return Ok(()) };
        let (name, value, range) = match classic.coverage {
            ClassicCoverage::AlphaToCoverage { samples: 1 } => {
                ("samples", 1, "more than 1 for alpha to coverage")
            }
            ClassicCoverage::DepthPeeling { layers }
                if !(1..=ClassicCoverage::MAX_LAYERS).contains(&layers) =>
            {
                ("layers", layers, "1 to 16")
            }
            _ => return Ok(()),
        };
        Err(Error::Parameter { name, value: value.to_string(), range })
    }

    /// Returns the samples per pixel of the targets.
    pub fn samples(self) -> u32 {
        match self {
            Self::Tiles(TileOptions { sample_count: samples, .. })
            | Self::Masks(MaskOptions { sample_count: samples, .. })
            | Self::Classic(ClassicOptions {
                coverage: ClassicCoverage::AlphaToCoverage { samples }, ..
            }) => samples,
            Self::Classic(_) => 1,
        }
    }

    /// Returns this renderer with at most `max` samples per pixel.
    #[must_use]
    pub fn with_max_samples(mut self, max: u32) -> Self {
        match &mut self {
            Self::Tiles(TileOptions { sample_count: samples, .. })
            | Self::Masks(MaskOptions { sample_count: samples, .. })
            | Self::Classic(ClassicOptions {
                coverage: ClassicCoverage::AlphaToCoverage { samples }, ..
            }) => *samples = (*samples).min(max),
            Self::Classic(_) => {}
        }
        self
    }

    /// Returns the shading model.
    pub fn shading(self) -> ShadingModel {
        match self {
            Self::Tiles(TileOptions { shading, .. }) | Self::Masks(MaskOptions { shading, .. }) => shading,
            Self::Classic(_) => ShadingModel::KajiyaKay,
        }
    }

    /// Returns where hair is shaded.
    pub fn rate(self) -> ShadingRate {
        match self {
            Self::Classic(classic) => classic.rate,
            _ => ShadingRate::PerVertex,
        }
    }

    /// Returns the maximum number of lights with shadow maps.
    pub(crate) fn max_shadow_maps(self) -> u32 {
        match self.rate() {
            ShadingRate::PerVertex => MAX_LIGHTS,
            ShadingRate::PerPixel => LIGHT_GROUP,
        }
    }

    /// Returns the method that counts the hair between a light and a point.
    pub fn shadows(self) -> ShadowMethod {
        match self {
            Self::Classic(classic) => classic.shadows,
            _ => ShadowMethod::DeepOpacity,
        }
    }

    /// Returns this renderer with shading per vertex.
    pub(crate) fn per_vertex(self) -> Self {
        match self {
            Self::Classic(classic) => {
                Self::Classic(ClassicOptions { rate: ShadingRate::PerVertex, ..classic })
            }
            other => other,
        }
    }

    /// Returns this renderer with the options that its render targets do not depend on at their defaults.
    pub(crate) fn targets(self) -> Self {
        match self {
            Self::Tiles(_) | Self::Masks(_) => self.with_shading(ShadingModel::Fiber),
            Self::Classic(ClassicOptions { coverage, .. }) => Self::classic(coverage),
        }
    }

    /// Whether hair is drawn by [`Tiles`](Self::Tiles).
    pub(crate) fn is_tiles(self) -> bool {
        matches!(self, Self::Tiles(_))
    }

    /// Whether bodies are drawn before the hair, as blended hair requires. Otherwise they are drawn after it, which is
    /// cheaper: a body costs more shading per pixel, and hair hides most of the scalp.
    pub(crate) fn draws_bodies_first(self) -> bool {
        self.is_tiles() || self.layers().is_some()
    }

    /// Returns the number of peeled layers, `None` without depth peeling.
    pub(crate) fn layers(self) -> Option<u32> {
        match self {
            Self::Classic(ClassicOptions { coverage: ClassicCoverage::DepthPeeling { layers }, .. }) => {
                Some(layers.clamp(1, ClassicCoverage::MAX_LAYERS))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unsupported_sample_and_layer_counts_are_errors() {
        assert!(Renderer::alpha_to_coverage(1).check().is_err());
        assert!(Renderer::alpha_to_coverage(4).check().is_ok());
        for (layers, is_valid) in [(0, false), (1, true), (16, true), (17, false)] {
            assert_eq!(Renderer::peeling(layers).check().is_ok(), is_valid);
        }
    }
}
