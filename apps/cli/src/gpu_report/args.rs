//! Options of `tresses gpu`, and its parts.

use std::{path::PathBuf, time::Duration};

/// Options of `tresses gpu`.
#[derive(clap::Args, Debug)]
pub struct GpuArgs {
    /// Page to write; its JSON goes beside it
    #[arg(long, value_name = "PATH", default_value = "out/gpu-report.html")]
    pub out: PathBuf,
    /// Measure fewer frames
    #[arg(long)]
    pub quick: bool,
    /// Also run the tests of the library, with cargo from the folder of the repository
    #[arg(long)]
    pub tests: bool,
    /// Draw the scenes and store their images in a folder
    #[arg(long, value_name = "FOLDER", hide = true)]
    pub store: Option<PathBuf>,
    /// Run one part and print its section as lines of JSON
    #[arg(long, value_enum, hide = true)]
    pub part: Option<Part>,
}

/// Parts of the report, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// Adapters and backends.
    Adapters,
    /// Compilation of shaders.
    Shaders,
    /// Self-checks.
    Checks,
    /// Scenes beside stored images.
    Images,
    /// Microbenchmarks.
    Rates,
    /// Times of frames.
    Frames,
    /// Tests of the library.
    Tests,
}

impl Part {
    /// Parts that always run.
    const DEFAULT: [Self; 6] =
        [Self::Adapters, Self::Shaders, Self::Checks, Self::Images, Self::Rates, Self::Frames];

    /// Returns the parts that `args` select.
    pub fn selected(args: &GpuArgs) -> Vec<Self> {
        Self::DEFAULT.into_iter().chain(args.tests.then_some(Self::Tests)).collect()
    }

    /// Returns the name, as `--part` takes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Adapters => "adapters",
            Self::Shaders => "shaders",
            Self::Checks => "checks",
            Self::Images => "images",
            Self::Rates => "rates",
            Self::Frames => "frames",
            Self::Tests => "tests",
        }
    }

    /// Returns a description.
    pub fn about(self) -> &'static str {
        match self {
            Self::Adapters => "Adapters and backends with their limits and features",
            Self::Shaders => "Shaders compiled as modules and pipelines",
            Self::Checks => "Self-checks of read-back, images and strands",
            Self::Images => "Scenes beside stored images of a software driver",
            Self::Rates => "Microbenchmarks of dispatches, passes, atomics and loads",
            Self::Frames => "Times of frames per stage",
            Self::Tests => "Tests of the library",
        }
    }

    /// Returns the time after which the part is stopped.
    pub fn limit(self) -> Duration {
        Duration::from_secs(match self {
            Self::Adapters | Self::Checks => 120,
            Self::Shaders | Self::Images | Self::Rates | Self::Frames => 600,
            Self::Tests => 3600,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn names_match_the_option() {
        for part in Part::value_variants() {
            assert_eq!(part.to_possible_value().unwrap().get_name(), part.name());
        }
    }
}
