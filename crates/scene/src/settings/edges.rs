//! How finely pictures are sampled, and how strands thinner than a pixel cover it.

use super::Settings;
use tresses::{Error, Result, draw::Coverage, light::ShadingRate};

/// Samples per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // The names say it.
pub enum Samples {
    One = 1,
    Four = 4,
    Eight = 8,
    Sixteen = 16,
}

/// Antialiasing. Samples and coverage count where [`Settings::gives`] them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSettings {
    /// Samples per pixel; if automatic 1 where strands are peeled, 4 of bodies where they are drawn by tiles, else 8
    /// or as many as the adapter offers.
    pub(crate) samples: Samples,
    /// How strands cover pixels, whatever number of layers it says; if automatic, by tiles. Where hair is shaded for
    /// each pixel, or a number of layers is given, it is peeled, or a mask with several samples.
    pub(crate) coverage: Coverage,
    /// Layers that are peeled; hair behind them is blended by its depth.
    pub layers: u32,
    /// Pixels drawn per pixel shown, along each axis: 1 or 2.
    pub ssaa: u32,
}

impl Default for EdgeSettings {
    fn default() -> Self {
        let layers = match Coverage::PEELING {
            Coverage::DepthPeeling { layers } => layers,
            _ => 4,
        };
        Self { samples: Samples::Four, coverage: Coverage::Tiles, layers, ssaa: 1 }
    }
}

impl Settings {
    /// Samples and coverage where the adapter offers `most` samples.
    ///
    /// # Errors
    /// Where they do not go together.
    pub fn sampling(&self, most: u32) -> Result<(u32, Coverage)> {
        let given = self.gives("edges.samples").then_some(self.edges.samples);
        let peeled = Coverage::DepthPeeling { layers: self.edges.layers };
        let per_pixel = self.shading_rate() == ShadingRate::PerPixel;
        let coverage = match (self.gives("edges.coverage").then_some(self.edges.coverage), given) {
            (Some(Coverage::DepthPeeling { .. }), _) => peeled,
            (Some(coverage), _) => coverage,
            // All layers in order are quieter and nearer to the truth than some of them, or any number of samples.
            (None, _) if !per_pixel && self.edges.layers == EdgeSettings::default().layers => Coverage::Tiles,
            (None, None | Some(Samples::One)) => peeled,
            (None, Some(_)) => Coverage::SampleMask,
        };
        let samples = match given {
            Some(samples) => samples as u32,
            None if coverage == peeled => 1,
            // Of bodies alone.
            None if coverage == Coverage::Tiles => most.min(Samples::Four as u32),
            None => most.min(Samples::Eight as u32),
        };
        let refuse =
            |value: &str, range| Err(Error::Parameter { name: "coverage", value: value.to_owned(), range });
        if coverage == peeled && samples != 1 {
            return refuse(
                "peel",
                "mask or alpha with several samples per pixel: peeled strands are blended in one sample",
            );
        }
        if coverage == Coverage::AlphaToCoverage && samples == 1 {
            return refuse("alpha", "tiles, mask or peel with one sample per pixel: alpha needs several");
        }
        if coverage == Coverage::Tiles && per_pixel {
            return refuse(
                "tiles",
                "mask, alpha or peel where hair is shaded for each pixel: tiles blend what is shaded at vertices",
            );
        }
        coverage.check(samples)?;
        Ok((samples, coverage))
    }

    pub(super) fn check_edges(&self) -> Result<()> {
        self.sampling(Samples::Sixteen as u32)?;
        // Whether they are used or not.
        Coverage::DepthPeeling { layers: self.edges.layers }.check(1)
    }

    pub(super) fn resolve_edges(&self, into: &mut Self) {
        let Ok((samples, coverage)) = self.sampling(Samples::Eight as u32) else { return };
        into.edges.samples = match samples {
            1 => Samples::One,
            4 => Samples::Four,
            8 => Samples::Eight,
            _ => Samples::Sixteen,
        };
        into.edges.coverage = coverage;
        into.take_as_given(["edges.samples", "edges.coverage"].into_iter());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Value;

    #[test]
    fn samples_and_coverage_fit_together() {
        let choose = |samples: &'static str, coverage: &'static str, most| {
            let mut settings = Settings::default();
            let value = |name| if name == "auto" { Value::Auto } else { Value::Choice(name) };
            settings.set("edges.samples", value(samples)).unwrap();
            settings.set("edges.coverage", value(coverage)).unwrap();
            settings.edges.layers = 2;
            settings.sampling(most).ok()
        };
        let two = Coverage::DepthPeeling { layers: 2 };
        // A number of layers is one for peeling.
        assert_eq!(choose("auto", "auto", 4), Some((1, two)));
        assert_eq!(choose("4", "auto", 4), Some((4, Coverage::SampleMask)));
        assert_eq!(choose("auto", "tiles", 16), Some((4, Coverage::Tiles)));
        assert_eq!(choose("1", "tiles", 16), Some((1, Coverage::Tiles)));
        assert_eq!(choose("auto", "mask", 16), Some((8, Coverage::SampleMask)));
        assert_eq!(choose("auto", "mask", 4), Some((4, Coverage::SampleMask)));
        assert_eq!(choose("1", "auto", 8), Some((1, two)));
        assert_eq!(choose("1", "mask", 8), Some((1, Coverage::SampleMask)));
        assert_eq!(choose("1", "alpha", 8), None);
        assert_eq!(choose("4", "peel", 8), None);
        let mut settings = Settings::default();
        assert_eq!(settings.sampling(8).unwrap(), (4, Coverage::Tiles));
        settings.set("edges.samples", Value::Choice("8")).unwrap();
        assert_eq!(settings.sampling(8).unwrap(), (8, Coverage::Tiles));
        settings.shading.rate = ShadingRate::PerPixel;
        assert_eq!(settings.sampling(8).unwrap(), (8, Coverage::SampleMask));
        settings.set("edges.coverage", Value::Choice("tiles")).unwrap();
        assert!(settings.sampling(8).is_err());
        let mut settings = Settings::default();
        settings.edges.layers = 17;
        assert!(settings.check_edges().is_err());
    }
}
