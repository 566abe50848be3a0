//! `tresses bench`: milliseconds per stage on scenes with published figures, from GPU timestamps.
//!
//! Each frame is submitted alone and waited for, so that a stage's time is its own. Medians are reported, because a
//! software driver shares its cores with other programs; the 95th percentile shows the spread.

mod adapter;
mod args;
mod crowd;
mod lod;
mod machine;
pub mod recorded;
mod report;
pub mod results;
mod sitting;
pub mod statistics;
mod strokes;
pub mod table;
pub mod workload;

pub use adapter::Adapter;
pub use args::{BenchArgs, PROCESSOR, TimingArgs};
pub use machine::Machine;
pub use sitting::Sitting;

use crate::{progress, say};
use anyhow::Result;
use report::BenchReport;
use tresses::low_level::wall;

/// Runs `tresses bench`.
pub(crate) fn run(args: &BenchArgs) -> Result<()> {
    let of_preset = |path| workload::of_preset(path, args.size, (args.distance, args.cards));
    let own = args.preset.as_ref().map(of_preset).transpose()?;
    let mut report = BenchReport { adapter: args.timing.adapter()?, ..BenchReport::default() };
    let (frames, clock) = (args.frames(), args.timing.clock().unwrap_or(wall));

    let mut groups = Vec::new();
    let mut counts = Vec::new();
    if !args.lod && !args.groom && args.crowd.is_none() && own.is_none() {
        groups.extend(workload::seed());
        groups.extend(workload::peer(&args.grooms, &args.head).into_iter().flatten());
        counts.extend(workload::strand_counts(args.quick));
    }
    groups.extend(own);
    let runs = groups.iter().map(|group| group.runs.len()).sum::<usize>()
        + counts.len()
        + if args.lod { 2 * lod::DISTANCES.len() } else { 0 }
        + if args.crowd.is_some() { 2 } else { 0 };
    let bar = progress::frames("measuring", runs as u64 * u64::from(frames));
    let sitting = Sitting { frames, clock, bar: &bar };

    // Each table is printed as soon as it is complete: a software driver takes minutes for all.
    let print = |text: String| {
        if !(args.timing.json || text.is_empty()) {
            bar.suspend(|| say!("{}", text.trim_end()));
        }
    };
    print(report.adapter.text());
    for group in &groups {
        let group = workload::measure(group, sitting)?;
        print(group.text());
        report.groups.push(group);
    }
    for strands in &counts {
        report.line.push(workload::point(*strands, sitting)?);
    }
    if !counts.is_empty() {
        print(report.line_text());
    }
    if args.lod {
        report.lod = lod::measure(sitting)?;
        print(lod::text(&report.lod));
    }
    if let Some(heads) = args.crowd {
        let crowd = crowd::measure(heads, sitting)?;
        print(crowd::text(&crowd));
        report.crowd = Some(crowd);
    }
    if args.groom {
        let strokes = strokes::measure(sitting)?;
        print(strokes::text(&strokes));
        report.strokes = Some(strokes);
    }
    bar.finish_and_clear();
    if args.timing.json {
        say!("{}", serde_json::to_string_pretty(&report)?);
    }
    Ok(())
}
