//! Coverage modes for strands thinner than a pixel.

use crate::{Error, Result};

/// How strands cover pixels that they are thinner than.
///
/// `docs/validation/coverage.md` has figures and images of each mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Coverage {
    /// A strip is drawn at least [`min_width`](crate::light::HairMaterial::min_width) pixels wide and covers only the
    /// fraction of the samples that corresponds to its true width; each strand covers a different set. One pass, no
    /// sorting, correct on average however many strands overlap. A pixel is the mean of the samples in a disc, which is
    /// wider than the pixel if it has few samples ([`Footprint`](crate::present::Footprint)); otherwise moving hair
    /// would shimmer. With a single sample the fraction is a probability: a strand ends where it becomes too thin for
    /// its own threshold.
    SampleMask,
    /// The exact covered fraction of the pixel becomes alpha, which the adapter turns into samples
    /// ([alpha to coverage](wgpu::MultisampleState::alpha_to_coverage_enabled)). One pass writes depth; a second one
    /// writes color where depth is equal. Needs more than one sample. Adapters map equal alpha to equal samples:
    /// overlapping thin strands hide each other, and dense thin hair covers too little.
    AlphaToCoverage,
    /// The exact covered fraction of the pixel becomes alpha, and strands are blended from front to back, one layer per
    /// pass over the geometry (Everitt 2001, "Interactive order-independent transparency"; Bavoil and Myers 2008). One
    /// sample per pixel.
    DepthPeeling {
        /// Layers blended in order, 1 to [`MAX_LAYERS`](Self::MAX_LAYERS). The hair behind them is blended by depth, at
        /// eight knots.
        layers: u32,
    },
    /// The exact covered fraction of the pixel becomes alpha, and a compute rasterizer ([`crate::draw::tiles`]) blends
    /// all strands from front to back. Only visible segments are shaded, at the vertices of the strands
    /// ([`ShadingRate::PerVertex`](crate::light::ShadingRate)). The number of samples per pixel applies to bodies only.
    #[default]
    Tiles,
}

impl Coverage {
    /// The largest number of layers.
    pub const MAX_LAYERS: u32 = 16;

    /// Depth peeling with four layers.
    pub const PEELING: Self = Self::DepthPeeling { layers: 4 };

    /// Checks that the mode supports `samples` per pixel.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it does not.
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

    /// Number of layers of [`DepthPeeling`](Self::DepthPeeling), 0 for other modes.
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
    fn unsupported_sample_and_layer_counts_are_errors() {
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
