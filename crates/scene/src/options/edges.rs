//! Multisampling, and coverage by strands thinner than a pixel.

use crate::settings::Settings;
use tresses::{Error, Result, draw::Coverage, light::ShadingRate};

impl Settings {
    /// Returns the sample count and the coverage mode for an adapter that supports up to `most` samples.
    ///
    /// # Errors
    /// Fails if the sample count and the coverage mode exclude each other.
    pub fn sampling(&self, most: u32) -> Result<(u32, Coverage)> {
        let given = self.gives("edges.samples").then_some(self.view.samples);
        let peeled = Coverage::DepthPeeling { layers: self.peeled_layers };
        let per_pixel = self.shading_rate() == ShadingRate::PerPixel;
        let coverage = match (self.gives("edges.coverage").then_some(self.view.coverage), given) {
            (Some(Coverage::DepthPeeling { .. }), _) => peeled,
            (Some(coverage), _) => coverage,
            // Blending all layers in order has less noise and error than peeling a few of them or any number of
            // samples.
            (None, _) if !per_pixel && peeled == Coverage::PEELING => Coverage::Tiles,
            (None, None | Some(1)) => peeled,
            (None, Some(_)) => Coverage::SampleMask,
        };
        let samples = match given {
            Some(samples) => samples,
            None if coverage == peeled => 1,
            // Tiled hair is not multisampled; the samples are for bodies.
            None if coverage == Coverage::Tiles => most.min(4),
            None => most.min(8),
        };
        let refuse =
            |value: &str, range| Err(Error::Parameter { name: "coverage", value: value.to_owned(), range });
        if coverage == peeled && samples != 1 {
            return refuse(
                "peel",
                "mask or alpha with several samples per pixel: depth peeling supports one sample only",
            );
        }
        if coverage == Coverage::AlphaToCoverage && samples == 1 {
            return refuse(
                "alpha",
                "tiles, mask or peel with one sample per pixel: alpha to coverage needs several",
            );
        }
        if coverage == Coverage::Tiles && per_pixel {
            return refuse(
                "tiles",
                "mask, alpha or peel with shading per pixel: tiles support shading per vertex only",
            );
        }
        coverage.check(samples)?;
        Ok((samples, coverage))
    }

    pub(super) fn check_edges(&self) -> Result<()> {
        self.sampling(16)?;
        // Checked even if depth peeling is not the current mode.
        Coverage::DepthPeeling { layers: self.peeled_layers }.check(1)
    }

    pub(super) fn resolve_edges(&self, into: &mut Self) {
        let Ok((samples, coverage)) = self.sampling(8) else { return };
        (into.view.samples, into.view.coverage) = (samples, coverage);
        into.take_as_given(["edges.samples", "edges.coverage"].into_iter());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Value;

    #[test]
    fn sampling_resolves_samples_and_coverage() {
        let choose = |samples: &'static str, coverage: &'static str, most| {
            let mut settings = Settings::default();
            let value = |name| if name == "auto" { Value::Auto } else { Value::Choice(name) };
            settings.set("edges.samples", value(samples)).unwrap();
            settings.set("edges.coverage", value(coverage)).unwrap();
            settings.peeled_layers = 2;
            settings.sampling(most).ok()
        };
        let two = Coverage::DepthPeeling { layers: 2 };
        // A nondefault layer count selects depth peeling.
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
        let settings = Settings { peeled_layers: 17, ..Settings::default() };
        assert!(settings.check_edges().is_err());
    }
}
