//! `tresses bench`: milliseconds per stage from GPU timestamps, on scenes with published figures.
//!
//! Every frame is submitted and waited for alone, so that a stage's time is its own. Medians are reported
//! because a software driver shares its cores with everything else; the 95th percentile shows their spread.

mod appearance;
mod costs;
mod crowd;
mod lod;
mod recorded;
mod report;
mod roofline;
mod statistics;
mod workload;

use crate::{args::Size, progress, say};
use anyhow::{Result, bail};
use indicatif::ProgressBar;
use report::{Adapter, Report};
use std::path::PathBuf;
use tresses::gpu::{Clock, Gpu, wall};

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

/// How everything of one call is measured.
#[derive(Clone, Copy)]
struct Sitting<'a> {
    frames: u32,
    clock: Clock,
    bar: &'a ProgressBar,
}

/// The processor time of all threads of this process.
#[cfg(unix)]
fn processor() -> std::time::Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    std::time::Duration::new(now.tv_sec.unsigned_abs(), now.tv_nsec as u32)
}

impl Args {
    #[cfg(unix)]
    fn clock(&self) -> Option<Clock> {
        self.cpu.then_some(processor as Clock)
    }

    #[cfg(not(unix))]
    fn clock(&self) -> Option<Clock> {
        None
    }

    fn frames(&self) -> u32 {
        self.frames.unwrap_or(if self.quick { 8 } else { 30 })
    }
}

/// Runs `tresses bench`.
pub fn run(args: &Args) -> Result<()> {
    let own = args.preset.as_ref().map(|path| workload::own(path, args)).transpose()?;
    let gpu = pollster::block_on(Gpu::open())?;
    let mut report = Report { adapter: Adapter::of(&gpu), ..Report::default() };
    let software = gpu.tier.software;
    report.adapter.processor_time = args.clock().is_some();
    if report.adapter.processor_time && !software {
        bail!(
            "--cpu is for software adapters; what {} does is not done by the processor",
            report.adapter.name
        );
    }
    drop(gpu);
    if args.roofline {
        let workload = own.unwrap_or_else(workload::long);
        let bar = progress::frames("measuring", u64::from(args.frames()));
        let sitting = Sitting { frames: args.frames(), clock: args.clock().unwrap_or(wall), bar: &bar };
        let roofline = roofline::measure(&workload, sitting)?;
        bar.finish_and_clear();
        if args.json {
            report.roofline = Some(roofline);
            say!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            say!("{}{}", report.adapter.text(), roofline::text(&roofline).trim_end());
        }
        return Ok(());
    }
    if let Some(heads) = args.crowd {
        let bar = progress::frames("measuring", 2 * u64::from(args.frames()));
        let sitting = Sitting { frames: args.frames(), clock: args.clock().unwrap_or(wall), bar: &bar };
        let crowd = crowd::measure(heads, sitting)?;
        bar.finish_and_clear();
        if args.json {
            report.crowd = Some(crowd);
            say!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            say!("{}{}", report.adapter.text(), crowd::text(&crowd).trim_end());
        }
        return Ok(());
    }
    let mut groups = Vec::new();
    let mut counts = Vec::new();
    let mut looks = Vec::new();
    let all = !(args.scenes || args.costs || args.appearance || args.lod || own.is_some());
    groups.extend(own);
    if all || args.appearance {
        looks.extend(appearance::variants().into_iter().filter(|look| look.fits(report.adapter.max_samples)));
    }
    if all || args.scenes {
        groups.extend(workload::seed());
        groups.extend(workload::peer(args).into_iter().flatten());
        counts.extend(workload::strand_counts(args.quick));
    }
    let frames = args.frames();
    let scenes: usize = groups.iter().map(|group| group.runs.len()).sum();
    let costs = if all || args.costs { costs::RUNS } else { 0 };
    let runs = scenes as u64
        + counts.len() as u64
        + costs
        + if args.lod { 2 * lod::DISTANCES.len() as u64 } else { 0 };
    let look_frames = match args.frames {
        None if software => appearance::SOFTWARE_FRAMES,
        _ => frames,
    };
    let measured = runs * u64::from(frames) + looks.len() as u64 * u64::from(look_frames);
    let bar = progress::frames("measuring", measured);
    let sitting = Sitting { frames, clock: args.clock().unwrap_or(wall), bar: &bar };
    // Each table as soon as it is known: a software driver takes minutes for all.
    let tell = |text: String| {
        if !(args.json || text.is_empty()) {
            bar.suspend(|| say!("{}", text.trim_end()));
        }
    };
    tell(report.adapter.text());
    for group in &groups {
        let group = workload::measure(group, sitting)?;
        tell(group.text());
        report.groups.push(group);
    }
    if costs > 0 {
        report.costs = costs::measure(sitting)?;
        tell(report.costs_text());
    }
    if args.lod {
        report.lod = lod::measure(sitting)?;
        tell(lod::text(&report.lod));
    }
    for variant in &looks {
        report.looks.push(appearance::measure(
            variant,
            software,
            Sitting { frames: look_frames, ..sitting },
        )?);
    }
    tell(report.looks_text());
    for strands in &counts {
        report.line.push(workload::point(*strands, sitting)?);
    }
    if !counts.is_empty() {
        tell(report.line_text());
    }
    bar.finish_and_clear();
    if args.json {
        say!("{}", serde_json::to_string_pretty(&report)?);
    }
    Ok(())
}
