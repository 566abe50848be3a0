//! How finely pictures are sampled, and how strands thinner than a pixel cover it.

use tresses::{Error, Result, draw::Coverage, light::HairMaterial};

/// Samples per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // The names say it.
pub enum Samples {
    One = 1,
    Four = 4,
    Eight = 8,
    Sixteen = 16,
}

/// How strands cover pixels; [`Coverage`] says more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoverageMode {
    /// Each strand covers its share of a pixel's samples.
    Mask,
    /// The adapter turns a strand's share of a pixel into samples.
    Alpha,
    /// Strands are blended, front to back.
    Peel,
}

/// Antialiasing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edges {
    /// Samples per pixel; `None`: 1 where strands are peeled, else 8 or as many as the adapter offers.
    pub samples: Option<Samples>,
    /// How strands cover pixels; `None`: peeled with one sample, a mask with more.
    pub coverage: Option<CoverageMode>,
    /// Layers that are peeled; hair behind them is blended by its depth.
    pub layers: u32,
    /// Pixels drawn per pixel shown, along each axis: 1 or 2.
    pub ssaa: u32,
    /// The least width that strands are drawn with, pixels; thinner ones are as much sparser.
    pub min_width: f32,
}

impl Default for Edges {
    fn default() -> Self {
        let layers = match Coverage::PEELING {
            Coverage::DepthPeeling { layers } => layers,
            _ => 4,
        };
        let min_width = HairMaterial::default().min_width;
        Self { samples: None, coverage: None, layers, ssaa: 1, min_width }
    }
}

impl Edges {
    /// Samples and coverage where the adapter offers `most` samples.
    ///
    /// # Errors
    /// Where they do not go together.
    pub fn choose(&self, most: u32) -> Result<(u32, Coverage)> {
        let mode = match (self.coverage, self.samples) {
            (Some(mode), _) => mode,
            // Sorted layers are quieter and nearer to the truth than any number of samples.
            (None, None | Some(Samples::One)) => CoverageMode::Peel,
            (None, Some(_)) => CoverageMode::Mask,
        };
        let samples = match self.samples {
            Some(samples) => samples as u32,
            None if mode == CoverageMode::Peel => 1,
            None => most.min(Samples::Eight as u32),
        };
        let refuse =
            |value: &str, range| Err(Error::Parameter { name: "coverage", value: value.to_owned(), range });
        if mode == CoverageMode::Peel && samples != 1 {
            return refuse(
                "peel",
                "mask or alpha with several samples per pixel: peeled strands are blended in one",
            );
        }
        if mode == CoverageMode::Alpha && samples == 1 {
            return refuse("alpha", "mask or peel with one sample per pixel: alpha needs several");
        }
        let coverage = match mode {
            CoverageMode::Mask => Coverage::SampleMask,
            CoverageMode::Alpha => Coverage::AlphaToCoverage,
            CoverageMode::Peel => Coverage::DepthPeeling { layers: self.layers },
        };
        coverage.check(samples)?;
        Ok((samples, coverage))
    }

    pub(super) fn check(&self) -> Result<()> {
        self.choose(Samples::Sixteen as u32)?;
        // Whether they are used or not.
        Coverage::DepthPeeling { layers: self.layers }.check(1)?;
        Ok(())
    }

    /// Whether samples and coverage go together.
    #[cfg(test)]
    pub(crate) fn check_together(&self) -> Result<()> {
        self.choose(Samples::Sixteen as u32).map(|_| ())
    }

    pub(super) fn resolve(&self, into: &mut Self) {
        let Ok((samples, coverage)) = self.choose(Samples::Eight as u32) else { return };
        into.samples = Some(match samples {
            1 => Samples::One,
            4 => Samples::Four,
            8 => Samples::Eight,
            _ => Samples::Sixteen,
        });
        into.coverage = Some(match coverage {
            Coverage::SampleMask => CoverageMode::Mask,
            Coverage::AlphaToCoverage => CoverageMode::Alpha,
            Coverage::DepthPeeling { .. } => CoverageMode::Peel,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_and_coverage_fit_together() {
        let none = Edges::default();
        assert_eq!(none.choose(4).unwrap(), (1, Coverage::PEELING));
        let four = Edges { samples: Some(Samples::Four), ..none };
        assert_eq!(four.choose(4).unwrap(), (4, Coverage::SampleMask));
        let masks = Edges { coverage: Some(CoverageMode::Mask), ..none };
        assert_eq!(masks.choose(16).unwrap(), (8, Coverage::SampleMask));
        assert_eq!(masks.choose(4).unwrap(), (4, Coverage::SampleMask));
        let one = Edges { samples: Some(Samples::One), ..none };
        assert_eq!(one.choose(8).unwrap(), (1, Coverage::PEELING));
        assert_eq!(Edges { layers: 2, ..one }.choose(8).unwrap(), (1, Coverage::DepthPeeling { layers: 2 }));
        let mask = Edges { coverage: Some(CoverageMode::Mask), ..one };
        assert_eq!(mask.choose(8).unwrap(), (1, Coverage::SampleMask));
        assert!(Edges { coverage: Some(CoverageMode::Alpha), ..one }.choose(8).is_err());
        assert!(Edges { coverage: Some(CoverageMode::Peel), ..four }.choose(8).is_err());
        assert!(Edges { layers: 17, ..mask }.check().is_err());
    }
}
