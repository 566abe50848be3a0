//! `tresses retarget`: fits a groom that was made on one head to another.

use crate::{files, orient_args::OrientArgs, say};
use anyhow::{Context, Result, ensure};
use std::path::PathBuf;
use tresses::groom::{
    export::Writer,
    import::{self, ImportOptions},
    orient::LengthUnit,
    retarget::{Landmark, retarget},
};

/// Options of `tresses retarget`.
#[derive(clap::Args, Debug)]
pub struct RetargetArgs {
    /// Groom files, joined into one groom
    #[arg(required = true, value_name = "GROOM")]
    grooms: Vec<PathBuf>,
    /// Head that the groom was made on
    #[arg(long, value_name = "MESH", required = true)]
    from: Vec<PathBuf>,
    /// Head that it is for
    #[arg(long, value_name = "MESH", required = true)]
    to: Vec<PathBuf>,
    /// Points of both heads that correspond, meters: lines of six numbers, x y z of the first and of the second
    #[arg(long, value_name = "FILE")]
    landmarks: Option<PathBuf>,
    /// File to write
    #[arg(long, value_name = "FILE", default_value = "out/hair.abc")]
    out: PathBuf,
    #[command(flatten)]
    orient: OrientArgs,
}

/// Runs `tresses retarget`.
pub fn run(args: &RetargetArgs) -> Result<()> {
    let writer = Writer::of(&args.out)?;
    files::prepare(&args.out)?;
    let options = args.orient.options();
    let (strands, head, report) = import::read_complete(&args.grooms, &args.from, &options)?;
    let head = head.context("--from has no mesh")?;
    for doubt in report.head_placement.iter().flat_map(|placement| &placement.doubts) {
        eprintln!("note: {}: {doubt}", args.from[0].display());
    }
    let (other, _) = import::read_head(&args.to, &ImportOptions::default())?;
    let landmarks = match &args.landmarks {
        Some(path) => {
            let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
            marks(&text).with_context(|| path.display().to_string())?
        }
        None => Vec::new(),
    };
    let (retargeted, done) = retarget(&strands, &head, &other, &landmarks)?;
    let encoded = writer.strands(&retargeted, Some(LengthUnit(1.0)))?;
    files::write(&args.out, &encoded.bytes)?;
    encoded.notes.iter().for_each(|note| eprintln!("note: {note}"));
    say!(
        "{}: {} strands; heads match {}; {:.2} % of the vertices deeper than 1 mm ({:.1} % before they were pushed out); bends change by {:.1}°, distances of neighbors by {:.1} mm",
        args.out.display(),
        retargeted.len(),
        match done.has_same_topology {
            true => "by their vertices".into(),
            false => format!("within {:.2} mm", 1e3 * done.skin_error),
        },
        100.0 * done.inside[1],
        100.0 * done.inside[0],
        done.bend.to_degrees(),
        1e3 * done.spacing_change,
    );
    Ok(())
}

fn marks(text: &str) -> Result<Vec<Landmark>> {
    let mut marks = Vec::new();
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let numbers: Result<Vec<f32>, _> = line.split_whitespace().map(str::parse).collect();
        let numbers = numbers.with_context(|| format!("line {}", number + 1))?;
        let six: Result<[f32; 6], _> = numbers.try_into();
        let Ok([a, b, c, d, e, f]) = six else {
            anyhow::bail!("line {} must have six numbers", number + 1);
        };
        ensure!(
            [a, b, c, d, e, f].iter().all(|v| v.is_finite()),
            "line {} must have finite numbers",
            number + 1
        );
        marks.push(Landmark { from: [a, b, c].into(), to: [d, e, f].into() });
    }
    Ok(marks)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn landmarks_are_lines_of_six_numbers() {
        let found = marks("0 1 2 3 4 5\n\n1 1 1 2 2 2\n").unwrap();
        assert_eq!((found.len(), found[0].to.to_array()), (2, [3.0, 4.0, 5.0]));
        for (text, said) in [("1 2 3", "six"), ("a b c d e f", "line 1"), ("0 0 0 0 0 nan", "finite")] {
            assert!(format!("{:#}", marks(text).unwrap_err()).contains(said));
        }
    }
}
