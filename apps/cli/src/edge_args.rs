//! How finely pictures are sampled, and how strands thinner than a pixel cover it.

use crate::args;
use anyhow::{Result, ensure};
use tresses::draw::Coverage;
use tresses_scene::{
    Settings,
    settings::{CoverageMode, Edges, Samples},
};

/// Antialiasing.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct EdgeArgs {
    /// Samples per pixel: 1, 4, 8 or 16 [default: 1 with --coverage peel, else 8 or as many as the adapter offers]
    #[arg(long, value_name = "N", value_parser = samples, help_heading = "Edges")]
    pub samples: Option<Samples>,
    /// Pixels drawn per pixel shown, along each axis; 2 costs four times as much [default: 1]
    #[arg(long, value_name = "N", value_parser = ssaa, help_heading = "Edges")]
    pub ssaa: Option<u32>,
    /// How strands thinner than a pixel cover it [default: peel, or mask with --samples 4 and more]
    #[arg(long, value_name = "MODE", value_enum, help_heading = "Edges")]
    pub coverage: Option<Mode>,
    /// How many layers of hair --coverage peel puts in order, 1 to 16; hair behind them is blended by its depth [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(Coverage::MAX_LAYERS)), help_heading = "Edges")]
    pub layers: Option<u32>,
}

/// How strands cover pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Mode {
    /// Each strand covers its share of a pixel's samples, which are others for each strand
    Mask,
    /// The adapter turns a strand's share of a pixel into samples; thin hair that overlaps comes out too sparse
    Alpha,
    /// Strands are blended, front to back: one pass over all hair per layer
    Peel,
}

impl From<Mode> for CoverageMode {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Mask => Self::Mask,
            Mode::Alpha => Self::Alpha,
            Mode::Peel => Self::Peel,
        }
    }
}

impl EdgeArgs {
    /// Puts what is given into `settings`; refuses what contradicts itself.
    pub fn apply(&self, settings: &mut Settings) -> Result<()> {
        let Edges { samples, coverage, layers, ssaa, .. } = &mut settings.edges;
        // Whoever gives one of these does not want the other of a preset, which was chosen with another.
        if self.samples.is_some() || self.coverage.is_some() {
            (*samples, *coverage) = (self.samples, self.coverage.map(Into::into));
        }
        *layers = self.layers.unwrap_or(*layers);
        *ssaa = self.ssaa.unwrap_or(*ssaa);
        let several = samples.is_some_and(|samples| samples != Samples::One);
        let mode = coverage.unwrap_or(if several { CoverageMode::Mask } else { CoverageMode::Peel });
        ensure!(
            self.layers.is_none() || mode == CoverageMode::Peel,
            "--layers is for --coverage peel: the other modes have none"
        );
        ensure!(
            mode != CoverageMode::Peel || !several,
            "--coverage peel blends strands in one sample per pixel: leave --samples out, or take --ssaa 2 for more"
        );
        ensure!(
            mode != CoverageMode::Alpha || *samples != Some(Samples::One),
            "--coverage alpha needs more than one sample per pixel: take mask or peel, or --samples 4"
        );
        Ok(())
    }
}

fn samples(text: &str) -> Result<Samples, String> {
    Ok(match args::samples(text)? {
        1 => Samples::One,
        4 => Samples::Four,
        8 => Samples::Eight,
        _ => Samples::Sixteen,
    })
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
        let choose = |args: EdgeArgs| {
            let mut settings = Settings::default();
            args.apply(&mut settings).map(|()| settings.edges.choose(8).unwrap())
        };
        let none = EdgeArgs::default();
        assert_eq!(choose(none).unwrap(), (1, Coverage::PEELING));
        let four = EdgeArgs { samples: Some(Samples::Four), ..none };
        assert_eq!(choose(four).unwrap(), (4, Coverage::SampleMask));
        assert!(choose(EdgeArgs { layers: Some(2), ..four }).is_err());
        let one = EdgeArgs { samples: Some(Samples::One), ..none };
        let two = EdgeArgs { layers: Some(2), ..none };
        assert_eq!(choose(two).unwrap(), (1, Coverage::DepthPeeling { layers: 2 }));
        let mask = EdgeArgs { coverage: Some(Mode::Mask), ..one };
        assert_eq!(choose(mask).unwrap(), (1, Coverage::SampleMask));
        assert!(choose(EdgeArgs { layers: Some(2), ..mask }).is_err());
        assert!(choose(EdgeArgs { coverage: Some(Mode::Alpha), ..one }).is_err());
        assert!(choose(EdgeArgs { coverage: Some(Mode::Peel), ..four }).is_err());
        assert!(ssaa("3").is_err() && ssaa("2") == Ok(2));
    }

    #[test]
    fn options_win_over_a_preset() {
        let mut settings = Settings::default();
        settings.edges = Edges { coverage: Some(CoverageMode::Peel), layers: 8, ssaa: 2, ..settings.edges };
        EdgeArgs { samples: Some(Samples::Four), ..Default::default() }.apply(&mut settings).unwrap();
        assert_eq!(settings.edges.choose(4).unwrap(), (4, Coverage::SampleMask));
        assert_eq!((settings.edges.layers, settings.edges.ssaa), (8, 2), "not given, so they stay");
    }
}
