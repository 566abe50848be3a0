//! The page `docs/benchmarks.md`: frames of the built-in styles by stage, a series of strand counts, memory, start of
//! the command, and the comparisons with other renderers in `peers.toml`.

mod frames;
mod load;
mod more;
mod page;
mod peers;
mod start;

use anyhow::{Context, Result, ensure};
use frames::FrameCase;
use load::Load;
use more::MoreTimes;
pub use page::model;
use peers::Peer;
use serde::Serialize;
use serde_json::Value;
use start::StartCase;
use std::path::{Path, PathBuf};
use tresses_cli::bench::{Adapter, Machine, Sitting, TimingArgs};

/// The built-in styles; the first is the default of the command.
const STYLES: [&str; 4] = ["long", "bob", "curly", "short"];
/// Strand counts of the series beside the style's own, and whether every strand is simulated.
const COUNTS: [(u32, bool); 4] = [(1_000, false), (10_000, false), (100_000, false), (10_000, true)];
/// Runs of up to the requested number of frames: by stage, and whole.
pub const RUNS: u64 = 2 * (STYLES.len() + COUNTS.len()) as u64;

/// Options of the page.
#[derive(clap::Args)]
pub struct PageArgs {
    /// The page to write
    #[arg(long, value_name = "FILE", default_value = "docs/benchmarks.md")]
    out: PathBuf,
    /// The `tresses` command whose start is measured [default: the one beside this program]
    #[arg(long, value_name = "PROGRAM")]
    command: Option<PathBuf>,
    /// Measure distances, crowds, methods of drawing and parts of the simulation too, about fifteen minutes on a
    /// software driver
    #[arg(long)]
    full: bool,
}

/// Contents of the page.
#[derive(Serialize)]
struct Measurements {
    adapter: Adapter,
    machine: Machine,
    /// Share of the cores that other programs used meanwhile, if the system reports it.
    other_load: Option<f64>,
    styles: Vec<FrameCase>,
    counts: Vec<FrameCase>,
    starts: Vec<StartCase>,
    /// The model of frames on GPUs, as Markdown.
    model: String,
    more: Option<MoreTimes>,
    peers: Vec<Peer>,
}

/// Measures, and writes the page. Returns its path, and the measurements as JSON.
pub fn run(
    args: &PageArgs,
    timing: &TimingArgs,
    adapter: &Adapter,
    sitting: Sitting<'_>,
) -> Result<(String, Value)> {
    let program = program(args.command.as_deref())?;
    let peers = peers::read()?;
    let load = Load::start();
    let styles = STYLES.iter().map(|style| frames::measure(style, None, false, sitting));
    let styles = styles.collect::<Result<_>>()?;
    let counts = COUNTS.iter().map(|(count, all)| frames::measure(STYLES[0], Some(*count), *all, sitting));
    let counts = counts.collect::<Result<_>>()?;
    sitting.bar.finish_and_clear();
    let starts = start::measure(&program)?;
    let more = args.full.then(|| more::measure(&program, timing, adapter)).transpose()?;
    let measurements = Measurements {
        adapter: adapter.clone(),
        machine: Machine::this(),
        other_load: load.and_then(|load| load.others()),
        styles,
        counts,
        starts,
        model: model()?,
        more,
        peers,
    };
    std::fs::write(&args.out, page::text(&measurements))
        .with_context(|| format!("cannot write {}", args.out.display()))?;
    Ok((args.out.display().to_string(), serde_json::to_value(measurements)?))
}

/// Returns the `tresses` command to measure.
fn program(given: Option<&Path>) -> Result<PathBuf> {
    let sibling = || -> Result<PathBuf> {
        let name = format!("tresses{}", std::env::consts::EXE_SUFFIX);
        Ok(std::env::current_exe()?.with_file_name(name))
    };
    let program = given.map_or_else(sibling, |path| Ok(path.to_owned()))?;
    ensure!(
        program.is_file(),
        "{}: there is no such program; build it with `cargo build --bin tresses`, or name it with --command",
        program.display()
    );
    Ok(program)
}
