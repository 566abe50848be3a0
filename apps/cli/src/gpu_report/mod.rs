//! `tresses gpu`: tests and measures this machine's GPU, for a person who sends the report to the maintainers.
//!
//! Each part runs in a process of its own, so that a lost device or a crash of the driver costs one part. The report is
//! written before and after each part; if this process is interrupted, the files contain the parts until then.

mod adapters;
mod args;
mod checks;
mod device;
mod difference;
mod frames;
mod html;
mod images;
mod in_flight;
mod parts;
mod rates;
mod report;
mod scenes;
mod section;
mod shaders;
mod suite;
mod worker;

pub use args::GpuArgs;

use crate::{files, say};
use anyhow::{Result, ensure};
use args::Part;
use report::{HostInfo, Report};
use section::ReportSection;
use std::time::Instant;

/// Runs `tresses gpu`.
pub fn run(args: &GpuArgs) -> Result<()> {
    if let Some(part) = args.part {
        parts::run(part, args);
        return Ok(());
    }
    if let Some(folder) = &args.store {
        return images::store(folder);
    }
    ensure!(
        args.out.extension().is_some_and(|extension| extension == "html"),
        "{}: the report is a page; choose a name that ends in .html",
        args.out.display()
    );
    files::prepare(&args.out)?;
    let parts = Part::selected(args);
    let mut report = Report { verdict: String::new(), host: HostInfo::current(), sections: Vec::new() };
    for (i, part) in parts.iter().enumerate() {
        say!("{} of {}: {}", i + 1, parts.len(), part.about());
        let running = ReportSection {
            name: part.name().into(),
            about: part.about().into(),
            ..ReportSection::default()
        };
        report.sections.push(running);
        write(args, &mut report)?;
        let section = worker::run(*part, args);
        section.findings.iter().for_each(|finding| say!("  {}", finding.lines().next().unwrap_or_default()));
        report.sections[i] = section;
        write(args, &mut report)?;
    }
    say!("{}", report.verdict);
    say!("{}\n{}", args.out.display(), args.out.with_extension("json").display());
    Ok(())
}

/// Returns the time since `start`, milliseconds.
fn milliseconds(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

/// Writes the page and its JSON.
fn write(args: &GpuArgs, report: &mut Report) -> Result<()> {
    report.verdict = report::verdict(&report.sections);
    files::write(&args.out.with_extension("json"), &serde_json::to_vec_pretty(report)?)?;
    files::write(&args.out, html::page(report).as_bytes())
}
