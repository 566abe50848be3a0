//! `tresses bench`: milliseconds per stage from GPU timestamps, on scenes with published figures.
//!
//! Every frame is submitted and waited for alone, so that a stage's time is its own. Medians are reported
//! because a software driver shares its cores with everything else; the 95th percentile shows their spread.

mod appearance;
mod args;
mod costs;
mod crowd;
mod lod;
mod recorded;
mod report;
mod results;
mod roofline;
mod sitting;
mod statistics;
mod table;
mod workload;

pub use args::Args;

use crate::{progress, say};
use anyhow::{Result, bail};
use report::{Adapter, Report};
use sitting::Sitting;
use tresses::gpu::{Gpu, wall};

/// Runs `tresses bench`.
pub fn run(args: &Args) -> Result<()> {
    let own = args.preset.as_ref().map(|path| workload::own(path, args)).transpose()?;
    let gpu = pollster::block_on(Gpu::open())?;
    let mut report = Report { adapter: Adapter::of(&gpu), ..Report::default() };
    let software = gpu.context.tier().software;
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
