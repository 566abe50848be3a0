//! The options of `tresses bench`.

use crate::args::Size;
use std::path::PathBuf;
use tresses::gpu::Clock;

/// The options of `tresses bench`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Groom files to simulate entirely, next to the built-in scenes [default: Sintel's in $TRESSES_ASSETS]
    #[arg(value_name = "GROOM")]
    pub grooms: Vec<PathBuf>,
    /// The head of that groom
    #[arg(long, value_name = "MESH", requires = "grooms")]
    pub head: Vec<PathBuf>,
    /// Measure only the hair and the settings of a preset
    #[arg(long, value_name = "FILE", conflicts_with_all = ["grooms", "costs", "appearance", "lod"])]
    pub preset: Option<PathBuf>,
    /// The size of that preset's picture, pixels
    #[arg(long, value_name = "WxH", requires = "preset", default_value = "1280x720")]
    pub size: Size,
    /// How far the camera is from that preset's hair, metres [default: a portrait's]
    #[arg(long, requires = "preset")]
    pub distance: Option<f32>,
    /// Measured frames per scene [default: 30, or 8 with --quick; for --appearance on a software adapter 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Measure fewer frames and fewer strand counts
    #[arg(long)]
    pub quick: bool,
    /// Measure only the published scenes, and the time over the number of strands
    #[arg(long, conflicts_with_all = ["costs", "appearance", "lod", "preset"])]
    pub scenes: bool,
    /// Measure only the parts of the simulation, compared with each other
    #[arg(long)]
    pub costs: bool,
    /// Measure only the ways to light, shade and draw hair, compared with each other
    #[arg(long, conflicts_with = "costs")]
    pub appearance: bool,
    /// Measure only what a frame costs at a distance, in full detail and at its level of detail
    #[arg(long, conflicts_with_all = ["costs", "appearance"])]
    pub lod: bool,
    /// Measure only so many heads with one groom at 2 to 40 m, beside one head in a portrait
    #[arg(long, value_name = "HEADS", value_parser = clap::value_parser!(u32).range(1..=1000), conflicts_with_all = ["grooms", "costs", "appearance", "lod", "scenes", "preset"])]
    pub crowd: Option<u32>,
    /// Measure only what each stage must cost at least, by what its shaders do and by what the adapter can do, beside what it
    /// costs: of a preset, or of the built-in long style
    #[arg(long, conflicts_with_all = ["grooms", "costs", "appearance", "lod", "scenes", "crowd"])]
    pub roofline: bool,
    /// On a software adapter, measure the processor time of all threads: unlike elapsed time it hardly depends on
    /// what else the machine does
    #[cfg(unix)]
    #[arg(long)]
    pub cpu: bool,
    /// Print JSON instead of tables
    #[arg(long)]
    pub json: bool,
}

/// The processor time of all threads of this process.
#[cfg(unix)]
fn processor() -> std::time::Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    std::time::Duration::new(now.tv_sec.unsigned_abs(), now.tv_nsec as u32)
}

impl Args {
    /// The clock that the options name; `None` for elapsed time.
    #[cfg(unix)]
    pub fn clock(&self) -> Option<Clock> {
        self.cpu.then_some(processor as Clock)
    }

    #[cfg(not(unix))]
    pub fn clock(&self) -> Option<Clock> {
        None
    }

    /// Measured frames per scene.
    pub fn frames(&self) -> u32 {
        self.frames.unwrap_or(if self.quick { 8 } else { 30 })
    }
}
