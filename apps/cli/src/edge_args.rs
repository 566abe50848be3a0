//! How finely pictures are sampled, and how strands thinner than a pixel cover it.

use crate::args;
use anyhow::{Result, ensure};
use tresses::draw::Coverage;

/// Antialiasing.
#[derive(clap::Args, Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeArgs {
    /// Samples per pixel: 1, 4, 8 or 16 [default: 8, or as many as the adapter offers; 1 with --coverage peel]
    #[arg(long, value_name = "N", value_parser = args::samples, help_heading = "Edges")]
    pub samples: Option<u32>,
    /// Pixels drawn per pixel shown, along each axis; 2 costs four times as much
    #[arg(long, value_name = "N", default_value = "1", value_parser = ssaa, help_heading = "Edges")]
    pub ssaa: u32,
    /// How strands thinner than a pixel cover it [default: mask, or peel with --samples 1]
    #[arg(long, value_name = "MODE", value_enum, help_heading = "Edges")]
    pub coverage: Option<Mode>,
    /// How many layers of hair --coverage peel puts in order, 1 to 16; hair behind them has its mean colour [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(Coverage::MAX_LAYERS)), help_heading = "Edges")]
    pub layers: Option<u32>,
}

/// How strands cover pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Mode {
    /// Each strand covers its share of a pixel's samples
    Mask,
    /// The adapter turns a strand's share of a pixel into samples; thin hair that overlaps comes out too sparse
    Alpha,
    /// Strands are blended, front to back: one pass over all hair per layer
    Peel,
}

impl Default for EdgeArgs {
    fn default() -> Self {
        Self { samples: None, ssaa: 1, coverage: None, layers: None }
    }
}

impl EdgeArgs {
    /// What the options come to where the adapter offers `most` samples; refuses what contradicts itself.
    pub fn choose(&self, most: u32) -> Result<(u32, Coverage)> {
        let mode = match (self.coverage, self.samples) {
            (Some(mode), _) => mode,
            (None, Some(1)) => Mode::Peel,
            _ if self.layers.is_some() => Mode::Peel,
            _ => Mode::Mask,
        };
        let samples = self.samples.unwrap_or(if mode == Mode::Peel { 1 } else { most.min(8) });
        ensure!(
            self.layers.is_none() || mode == Mode::Peel,
            "--layers is for --coverage peel: the other modes have none"
        );
        ensure!(
            mode != Mode::Peel || samples == 1,
            "--coverage peel blends strands in one sample per pixel: leave --samples out, or take --ssaa 2 for more"
        );
        ensure!(
            mode != Mode::Alpha || samples > 1,
            "--coverage alpha needs more than one sample per pixel: take mask or peel, or --samples 4"
        );
        let coverage = match mode {
            Mode::Mask => Coverage::SampleMask,
            Mode::Alpha => Coverage::AlphaToCoverage,
            Mode::Peel => self.layers.map_or(Coverage::PEELING, |layers| Coverage::DepthPeeling { layers }),
        };
        coverage.check(samples)?;
        Ok((samples, coverage))
    }
}

fn ssaa(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(n @ (1 | 2)) => Ok(n),
        _ => Err("choose 1 or 2".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_fit_together() {
        let none = EdgeArgs::default();
        assert_eq!(none.choose(4).unwrap(), (4, Coverage::SampleMask));
        assert_eq!(none.choose(16).unwrap(), (8, Coverage::SampleMask));
        let one = EdgeArgs { samples: Some(1), ..none };
        assert_eq!(one.choose(8).unwrap(), (1, Coverage::PEELING));
        let two = EdgeArgs { layers: Some(2), ..none };
        assert_eq!(two.choose(8).unwrap(), (1, Coverage::DepthPeeling { layers: 2 }));
        let mask = EdgeArgs { coverage: Some(Mode::Mask), ..one };
        assert_eq!(mask.choose(8).unwrap(), (1, Coverage::SampleMask));
        assert!(EdgeArgs { layers: Some(2), ..mask }.choose(8).is_err());
        assert!(EdgeArgs { coverage: Some(Mode::Alpha), ..one }.choose(8).is_err());
        let peel = EdgeArgs { coverage: Some(Mode::Peel), ..none };
        assert!(EdgeArgs { samples: Some(4), ..peel }.choose(8).is_err());
        assert!(ssaa("3").is_err() && ssaa("2") == Ok(2));
    }
}
