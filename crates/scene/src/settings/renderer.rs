//! Renderer settings.

use tresses::renderer::{ClassicCoverage, ShadingModel, ShadingRate, ShadowMethod};

/// A renderer, without its options.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RendererKind {
    /// [`tresses::renderer::Renderer::Tiles`].
    #[default]
    Tiles,
    /// [`tresses::renderer::Renderer::Masks`].
    Masks,
    /// [`tresses::renderer::Renderer::Classic`].
    Classic,
}

/// Coverage of the classic renderer, without its counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClassicBlending {
    /// Depth peeling.
    #[default]
    Peel,
    /// Alpha to coverage.
    Alpha,
}

/// How hair is drawn. Each renderer reads some of the fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RendererSettings {
    /// The renderer. Automatic: classic if one of its parameters is set, else tiles.
    pub kind: RendererKind,
    /// Samples per pixel. Automatic: as many as suit the renderer and the adapter.
    pub samples: u32,
    /// Shading model of tiles and masks.
    pub model: ShadingModel,
    /// Coverage (classic). Automatic: depth peeling.
    pub coverage: ClassicBlending,
    /// Number of peeled layers (classic). Hair behind the last layer is blended by its depth.
    pub layers: u32,
    /// Shading rate (classic).
    pub rate: ShadingRate,
    /// Shadow method (classic).
    pub shadows: ShadowMethod,
}

impl Default for RendererSettings {
    fn default() -> Self {
        Self {
            kind: RendererKind::default(),
            samples: 4,
            model: ShadingModel::default(),
            coverage: ClassicBlending::default(),
            layers: match ClassicCoverage::PEELING {
                ClassicCoverage::DepthPeeling { layers } => layers,
                ClassicCoverage::AlphaToCoverage { .. } => 4,
            },
            rate: ShadingRate::default(),
            shadows: ShadowMethod::default(),
        }
    }
}
