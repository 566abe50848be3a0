//! The renderer, with the samples that an adapter supports.

use crate::{
    knobs,
    settings::{ClassicBlending, RendererKind, RendererSettings, Settings},
};
use tresses::{
    Error, Result,
    renderer::{ClassicCoverage, ClassicOptions, MaskOptions, Renderer, TileOptions},
};

impl Settings {
    /// Returns the renderer for an adapter that supports up to `max_samples` samples.
    ///
    /// # Errors
    /// Fails if a parameter of the classic renderer is set for another one, or if the sample count does not suit the
    /// classic renderer's coverage.
    pub fn renderer(&self, max_samples: u32) -> Result<Renderer> {
        let RendererSettings { samples, model, coverage, layers, rate, shadows, .. } = self.renderer;
        let classic_row = self.classic_row();
        let kind = self.renderer_kind();
        if let (RendererKind::Tiles | RendererKind::Masks, Some(name)) = (kind, classic_row) {
            return Err(Error::Parameter {
                name,
                value: "set".into(),
                range: "left automatic or at its default: only renderer.kind classic has it",
            });
        }
        let given = self.gives("renderer.samples").then_some(samples);
        let refuse = |value: u32, range| {
            Err(Error::Parameter { name: "renderer.samples", value: value.to_string(), range })
        };
        let renderer = match kind {
            // Tiled hair is not multisampled; the samples are for bodies.
            RendererKind::Tiles => Renderer::Tiles(TileOptions {
                shading: model,
                sample_count: given.unwrap_or(max_samples.min(4)),
            }),
            RendererKind::Masks => Renderer::Masks(MaskOptions {
                shading: model,
                sample_count: given.unwrap_or(max_samples.min(8)),
            }),
            RendererKind::Classic => {
                let coverage = match (coverage, given) {
                    (ClassicBlending::Peel, Some(samples)) if samples != 1 => {
                        return refuse(samples, "1 for depth peeling: set renderer.coverage to alpha");
                    }
                    (ClassicBlending::Alpha, Some(1)) => {
                        return refuse(1, "more than 1 for alpha to coverage");
                    }
                    (ClassicBlending::Peel, _) => ClassicCoverage::DepthPeeling { layers },
                    (ClassicBlending::Alpha, samples) => {
                        ClassicCoverage::AlphaToCoverage { samples: samples.unwrap_or(max_samples.min(8)) }
                    }
                };
                Renderer::Classic(ClassicOptions { coverage, rate, shadows })
            }
        };
        renderer.check()?;
        Ok(renderer)
    }

    /// Returns the path of the first parameter that is set and that only the classic renderer has.
    fn classic_row(&self) -> Option<&'static str> {
        let (own, default) = (&self.renderer, RendererSettings::default());
        let is_set = [
            (self.gives("renderer.coverage"), "renderer.coverage"),
            (own.layers != default.layers, "renderer.layers"),
            (own.rate != default.rate, "renderer.rate"),
            (own.shadows != default.shadows, "renderer.shadows"),
        ];
        is_set.into_iter().find(|(is_set, _)| *is_set).map(|(_, path)| path)
    }

    /// Returns the renderer without its options: the chosen one, or the one that suits the options.
    pub fn renderer_kind(&self) -> RendererKind {
        match self.gives("renderer.kind") {
            true => self.renderer.kind,
            false if self.classic_row().is_some() => RendererKind::Classic,
            false => RendererKind::Tiles,
        }
    }

    /// Resets parameters that do not suit the renderer, after an interface has changed it or its coverage.
    pub fn fit_renderer(&mut self) {
        let kind = self.renderer_kind();
        let unread = knobs::section("renderer").filter(|row| row.renderer.is_some_and(|only| only != kind));
        for row in unread.chain(knobs::find("renderer.samples")) {
            row.reset(self);
        }
    }

    pub(super) fn check_renderer(&self) -> Result<()> {
        self.renderer(16)?;
        // Checked even if depth peeling is not the current coverage.
        Renderer::peeling(self.renderer.layers).check()
    }

    pub(super) fn resolve_renderer(&self, into: &mut Self) {
        let Ok(renderer) = self.renderer(8) else { return };
        into.renderer.kind = self.renderer_kind();
        into.renderer.samples = renderer.samples();
        into.take_as_given(["renderer.kind", "renderer.samples", "renderer.coverage"].into_iter());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Value;
    use tresses::renderer::{ShadingModel, ShadingRate, ShadowMethod};

    fn renderer(rows: &[(&str, &'static str)], max_samples: u32) -> Result<Renderer> {
        let mut settings = Settings::default();
        for (path, name) in rows {
            settings.set(path, Value::Choice(name)).unwrap();
        }
        settings.renderer(max_samples)
    }

    fn tiles(samples: u32) -> Renderer {
        Renderer::Tiles(TileOptions { sample_count: samples, ..TileOptions::default() })
    }

    #[test]
    fn automatic_renderer_follows_its_options() {
        assert_eq!(renderer(&[], 16).unwrap(), tiles(4));
        assert_eq!(renderer(&[("renderer.samples", "8")], 8).unwrap(), tiles(8));
        let masks =
            |samples| Renderer::Masks(MaskOptions { sample_count: samples, ..MaskOptions::default() });
        assert_eq!(renderer(&[("renderer.kind", "masks")], 16).unwrap(), masks(8));
        assert_eq!(renderer(&[("renderer.kind", "masks")], 4).unwrap(), masks(4));
        let one = [("renderer.kind", "masks"), ("renderer.samples", "1")];
        assert_eq!(renderer(&one, 8).unwrap(), masks(1));
        let classic = ClassicOptions::default();
        assert_eq!(renderer(&[("renderer.kind", "classic")], 8).unwrap(), Renderer::Classic(classic));
        let rate = ClassicOptions { rate: ShadingRate::PerPixel, ..classic };
        assert_eq!(renderer(&[("renderer.rate", "pixel")], 8).unwrap(), Renderer::Classic(rate));
        let alpha = |samples| ClassicOptions {
            coverage: ClassicCoverage::AlphaToCoverage { samples },
            shadows: ShadowMethod::Absorption,
            ..classic
        };
        let rows = [("renderer.coverage", "alpha"), ("renderer.shadows", "absorption")];
        assert_eq!(renderer(&rows, 16).unwrap(), Renderer::Classic(alpha(8)));
        let model = renderer(&[("shading.model", "kajiya-kay")], 4).unwrap();
        assert_eq!(model.shading(), ShadingModel::KajiyaKay);
    }

    #[test]
    fn options_of_another_renderer_are_errors() {
        for rows in [
            &[("renderer.kind", "tiles"), ("renderer.rate", "pixel")][..],
            &[("renderer.kind", "masks"), ("renderer.coverage", "alpha")],
            &[("renderer.kind", "tiles"), ("renderer.shadows", "opaque")],
            &[("renderer.kind", "classic"), ("renderer.samples", "4")],
            &[("renderer.coverage", "alpha"), ("renderer.samples", "1")],
        ] {
            let error = renderer(rows, 16).unwrap_err().to_string();
            assert!(error.contains("renderer."), "{error}");
        }
        let mut settings = Settings::default();
        for (path, name) in
            [("renderer.rate", "pixel"), ("renderer.samples", "1"), ("renderer.kind", "masks")]
        {
            settings.set(path, Value::Choice(name)).unwrap();
        }
        assert!(settings.renderer(16).is_err());
        settings.fit_renderer();
        assert_eq!(settings.renderer(16).unwrap(), Renderer::masks(8));
        let mut settings = Settings::default();
        settings.renderer.layers = 17;
        assert!(settings.check_renderer().is_err());
    }
}
