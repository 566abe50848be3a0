//! Coverage of pixels by strands thinner than a pixel.

use crate::{Error, Result};

/// How strands cover pixels that they are thinner than.
///
/// Figures and pictures of each stand in `docs/appearance/edges.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Coverage {
    /// A strip is drawn at least [`min_width`](crate::light::HairMaterial::min_width) pixels wide
    /// and covers only the share of the samples that it is too wide for, each strand others. One
    /// pass, no sorting, right on average however many strands overlap. A pixel is the mean of the
    /// samples in a disc, wider than itself when it has few ([`Footprint`](crate::present::Footprint)),
    /// or hair in motion would shimmer. With a single sample the share becomes a probability: a strand ends where it is too thin for its number.
    SampleMask,
    /// The exact share of the pixel becomes alpha, which the adapter turns into samples
    /// ([`alpha to coverage`](wgpu::MultisampleState::alpha_to_coverage_enabled)): a pass for the
    /// depth, and one for the colour that tests it and writes none. Needs more than one sample.
    /// Adapters give equal alpha to equal samples: thin strands that overlap hide behind each
    /// other, and dense thin hair covers too little.
    AlphaToCoverage,
    /// The exact share of the pixel becomes alpha, and strands are blended from front to back,
    /// one layer per pass over the geometry (Everitt 2001, "Interactive order-independent
    /// transparency"; Bavoil and Myers 2008). One sample per pixel.
    DepthPeeling {
        /// Layers in order, 1 to [`MAX_LAYERS`](Self::MAX_LAYERS); the hair behind them is
        /// blended by its depth, at eight knots.
        layers: u32,
    },
    /// The exact share of the pixel becomes alpha, and all strands are blended from front to back, by a rasteriser
    /// of compute shaders ([`crate::draw::tiles`]). Only what is seen is shaded, at the vertices of the strands
    /// ([`ShadingRate::PerVertex`](crate::light::ShadingRate)). Samples per pixel are those of bodies alone.
    #[default]
    Tiles,
}

impl Coverage {
    /// The most layers.
    pub const MAX_LAYERS: u32 = 16;

    /// Peeling of the seed's four layers.
    pub const PEELING: Self = Self::DepthPeeling { layers: 4 };

    /// Whether it can be drawn with `samples` per pixel.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it cannot.
    pub fn check(self, samples: u32) -> Result<()> {
        let (name, value, range) = match self {
            Self::AlphaToCoverage if samples == 1 => {
                ("samples", samples, "more than 1 for alpha to coverage")
            }
            Self::DepthPeeling { .. } if samples != 1 => ("samples", samples, "1 for depth peeling"),
            Self::DepthPeeling { layers } if !(1..=Self::MAX_LAYERS).contains(&layers) => {
                ("layers", layers, "1 to 16")
            }
            _ => return Ok(()),
        };
        Err(Error::Parameter { name, value: value.to_string(), range })
    }

    /// Whether hair is drawn by [`Tiles`](Self::Tiles).
    pub(crate) fn is_tiled(self) -> bool {
        self == Self::Tiles
    }

    /// The layers of [`DepthPeeling`](Self::DepthPeeling), else 0.
    pub(crate) fn layers(self) -> u32 {
        match self {
            Self::DepthPeeling { layers } => layers.clamp(1, Self::MAX_LAYERS),
            _ => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        for samples in [1, 4, 8] {
            assert!(Coverage::SampleMask.check(samples).is_ok());
            assert_eq!(Coverage::AlphaToCoverage.check(samples).is_ok(), samples > 1);
            assert_eq!(Coverage::PEELING.check(samples).is_ok(), samples == 1);
        }
        for layers in [0, 17] {
            assert!(Coverage::DepthPeeling { layers }.check(1).is_err());
        }
    }
}
