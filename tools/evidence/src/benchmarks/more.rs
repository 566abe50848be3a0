//! Measurements that take minutes on a software driver: distances, crowds, cards, parts of the simulation.

use crate::costs;
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::{path::Path, process::Command};
use tresses::low_level::wall;
use tresses_cli::{
    bench::{Adapter, Sitting, TimingArgs},
    progress,
};

/// Measured frames of each distance, of the crowd and of cards.
const FRAMES: &str = "3";
/// Measured frames of the parts of the simulation on software adapters.
const SIMULATED_FRAMES: u32 = 8;

/// Titles of the sections, and the commands that measure them alone.
pub const SECTIONS: [(&str, &str); 4] = [
    ("Distance", "tresses bench --lod --frames 3"),
    ("Crowd", "tresses bench --crowd 100 --frames 3"),
    ("Cards", "tresses bench --preset presets/silver.toml --cards 400 --frames 3"),
    ("Parts of the simulation", "tresses-evidence costs"),
];

/// The results as plain tables, in the order of [`SECTIONS`].
#[derive(Debug, Default, Serialize)]
pub struct MoreTimes(pub [String; SECTIONS.len()]);

/// Measures all of them.
pub fn measure(program: &Path, timing: &TimingArgs, adapter: &Adapter) -> Result<MoreTimes> {
    let distance = bench(program, &["--lod"], adapter)?;
    let crowd = bench(program, &["--crowd", "100"], adapter)?;
    let cards = bench(program, &["--preset", "presets/silver.toml", "--cards", "400"], adapter)?;
    let clock = timing.clock().unwrap_or(wall);
    let frames = if adapter.software { SIMULATED_FRAMES } else { 30 };
    let bar = progress::frames("measuring", costs::RUNS * u64::from(frames));
    let costs = costs::measure(Sitting { frames, clock, bar: &bar })?;
    bar.finish_and_clear();
    Ok(MoreTimes([distance, crowd, cards, costs.text()]))
}

/// Runs `tresses bench`, and returns its tables without the description of the adapter.
fn bench(program: &Path, options: &[&str], adapter: &Adapter) -> Result<String> {
    let clock: &[&str] = if adapter.processor_time { &["--cpu"] } else { &[] };
    let output = Command::new(program)
        .args(["bench", "--frames", FRAMES])
        .args(options)
        .args(clock)
        .output()
        .with_context(|| format!("cannot run {}", program.display()))?;
    ensure!(output.status.success(), "tresses bench: {}", String::from_utf8_lossy(&output.stderr).trim());
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.split_once("\n\n").map_or(&*text, |(_, tables)| tables).to_owned())
}
