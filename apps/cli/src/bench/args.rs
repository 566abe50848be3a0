//! Options of `tresses bench`.

use super::adapter::Adapter;
use crate::args::Size;
use anyhow::{Result, bail};
use std::path::PathBuf;
use tresses::{Gpu, groom::cards::CardOptions, low_level::Clock};

/// Options of `tresses bench`.
#[derive(clap::Args, Debug)]
pub struct BenchArgs {
    /// Groom files to simulate with every strand, next to the built-in scenes [default: Sintel's in $TRESSES_ASSETS]
    #[arg(value_name = "GROOM")]
    pub grooms: Vec<PathBuf>,
    /// Head mesh of that groom
    #[arg(long, value_name = "MESH", requires = "grooms")]
    pub head: Vec<PathBuf>,
    /// Measure only the hair and settings of a preset
    #[arg(long, value_name = "FILE", conflicts_with_all = ["grooms", "lod"])]
    pub preset: Option<PathBuf>,
    /// Image size for that preset, pixels
    #[arg(long, value_name = "WxH", requires = "preset", default_value = "1280x720")]
    pub size: Size,
    /// Distance of the camera from that preset's hair, meters [default: a portrait's]
    #[arg(long, requires = "preset")]
    pub distance: Option<f32>,
    /// Draw that preset's hair as this number of cards instead of strands
    #[arg(long, value_name = "N", requires = "preset", value_parser = clap::value_parser!(u32).range(1..=i64::from(CardOptions::MAX_CARDS)))]
    pub cards: Option<u32>,
    /// Measure fewer frames and fewer strand counts
    #[arg(long)]
    pub quick: bool,
    /// Measure frames at several distances, in full detail and at the matching level of detail
    #[arg(long)]
    pub lod: bool,
    /// Measure only a crowd of this many heads with one groom at 2 to 40 m, and one head in a portrait
    #[arg(long, value_name = "HEADS", value_parser = clap::value_parser!(u32).range(1..=1000), conflicts_with_all = ["grooms", "lod", "preset"])]
    pub crowd: Option<u32>,
    /// Measure only brushes on 5,000 guides, and 20,000 strands made anew after a stroke
    #[arg(long, conflicts_with_all = ["grooms", "lod", "preset", "crowd"])]
    pub groom: bool,
    /// Measurement and output.
    #[command(flatten)]
    pub timing: TimingArgs,
}

/// How frames are measured, and how the results are printed.
#[derive(clap::Args, Debug)]
pub struct TimingArgs {
    /// Measured frames per scene [default: 30, fewer where frames take seconds]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// On a software adapter, measure the processor time of all threads. Unlike elapsed time, it hardly depends on
    /// other programs
    #[cfg(unix)]
    #[arg(long)]
    pub cpu: bool,
    /// Print JSON instead of tables
    #[arg(long)]
    pub json: bool,
}

/// Processor time of all threads of this process; `None` where the system does not report it.
#[cfg(unix)]
pub const PROCESSOR: Option<Clock> = Some(|| {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    std::time::Duration::new(now.tv_sec.unsigned_abs(), now.tv_nsec as u32)
});
/// `None`: this system does not report processor time.
#[cfg(not(unix))]
pub const PROCESSOR: Option<Clock> = None;

impl TimingArgs {
    /// Returns the clock that the options select; `None` for elapsed time.
    #[cfg(unix)]
    pub fn clock(&self) -> Option<Clock> {
        PROCESSOR.filter(|_| self.cpu)
    }

    /// Returns `None`: this system has no processor time.
    #[cfg(not(unix))]
    pub fn clock(&self) -> Option<Clock> {
        None
    }

    /// Opens the default adapter, and returns its description.
    ///
    /// # Errors
    /// Fails without an adapter, and for processor time of an adapter that is no software.
    pub fn adapter(&self) -> Result<Adapter> {
        let gpu = pollster::block_on(Gpu::open())?;
        let adapter = Adapter { processor_time: self.clock().is_some(), ..Adapter::of(&gpu) };
        if adapter.processor_time && !adapter.software {
            bail!("--cpu needs a software adapter, but {} is a GPU", adapter.name);
        }
        Ok(adapter)
    }
}

impl BenchArgs {
    /// Returns the number of measured frames per scene.
    pub fn frames(&self) -> u32 {
        self.timing.frames.unwrap_or(if self.quick { 8 } else { 30 })
    }
}
