//! Time of whole runs of the command, from its start to the written image.

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::{
    path::Path,
    process::{Command, Stdio},
    time::Instant,
};
use tresses_cli::bench::statistics::Summary;

/// Measured runs per case, after one that fills the driver's shader cache.
pub const RUNS: u32 = 3;

/// The runs: description, options of `tresses render`.
const CASES: [(&str, &[&str]); 3] = [
    ("a small image of few strands", &["--size", "64x40", "--strands", "200"]),
    ("the default image, 1280×720, 20,000 strands", &[]),
    ("100,000 strands", &["--strands", "100000"]),
];

/// Time of one command.
#[derive(Debug, Default, Serialize)]
pub struct StartCase {
    /// Description.
    pub name: String,
    /// The command.
    pub command: String,
    /// Milliseconds.
    pub time: Summary,
}

/// Measures all cases with `program`.
pub fn measure(program: &Path) -> Result<Vec<StartCase>> {
    let image = std::env::temp_dir().join(format!("tresses-benchmarks-{}.png", std::process::id()));
    let cases = CASES.iter().map(|(name, options)| case(program, name, options, &image)).collect();
    let _ = std::fs::remove_file(&image);
    cases
}

fn case(program: &Path, name: &str, options: &[&str], image: &Path) -> Result<StartCase> {
    let command = ["tresses render"].iter().chain(options).copied().collect::<Vec<_>>().join(" ");
    let mut times = Vec::new();
    for run in 0..=RUNS {
        let start = Instant::now();
        let status = Command::new(program)
            .arg("render")
            .args(options)
            .arg("--out")
            .arg(image)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .with_context(|| format!("cannot run {}", program.display()))?;
        ensure!(status.success(), "`{command}` failed; run it alone to see why");
        if run > 0 {
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
    }
    Ok(StartCase { name: name.into(), command, time: Summary::of(times) })
}
