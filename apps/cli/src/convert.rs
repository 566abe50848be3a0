//! `tresses convert`: grooms from one format into another.

use std::path::PathBuf;

use anyhow::bail;
use tresses::groom::{
    export::{self, Format},
    import,
    orient::{Axis, Choice, Unit},
};

use crate::{
    files,
    orient_args::{MomentArgs, OrientArgs},
};

/// Convert grooms to .hair, .tfx, .obj, .data, .ply, .abc or .usda, in metres, Y up, face towards +Z.
#[derive(clap::Args)]
#[command(override_usage = "tresses convert [OPTIONS] <IN>... <OUT>")]
pub struct Args {
    /// Groom files (.tfx, .hair, .obj, .data, .ply, .abc, .usd), several are joined; the last one is the file to write, whose
    /// extension (.hair, .tfx, .obj, .data, .ply, .abc, .usda) decides the format.
    // One list, since two would forbid options between them.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The mesh that the groom grows on, to orient it by.
    #[arg(long, value_name = "MESH")]
    head: Vec<PathBuf>,
    /// Keep unit and axes of the input.
    #[arg(long)]
    as_is: bool,
    /// The unit of the file to write, .abc and .usda only: cm for Unreal and Maya [default: m]
    #[arg(long, value_name = "UNIT", conflicts_with = "as_is")]
    out_unit: Option<Unit>,
    #[command(flatten)]
    moment: MomentArgs,
    #[command(flatten)]
    orient: OrientArgs,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let Some((output, inputs)) = args.files.split_last().filter(|(_, inputs)| !inputs.is_empty()) else {
        bail!("convert needs at least one file to read and one to write");
    };
    let format = Format::of(output)?;
    let mut options = args.orient.options();
    options.moment = args.moment.moment();
    if args.as_is {
        options.orient =
            Choice { unit: Some(Unit(1.0)), up: Some(Axis::Y), front: Some(Axis::Z), mirror: Some(false) };
        // Lengths in an unknown unit cannot be called too short.
        options.unrepaired = true;
    }
    let (strands, report) = if args.head.is_empty() || args.as_is {
        import::read(inputs, &options)?
    } else {
        let (strands, _, report) = import::read_with_head(inputs, &args.head, &options)?;
        (strands, report)
    };
    let encoded = match args.out_unit {
        Some(unit) => export::encode_in(&strands, format, unit)?,
        None => export::encode(&strands, format, !args.as_is)?,
    };
    files::write(output, &encoded.bytes)?;
    let done = report.repaired;
    println!(
        "{}: {} strands, {} vertices ({} strands dropped, {} vertices merged, {} strands resampled)",
        output.display(),
        strands.len(),
        strands.positions.len(),
        done.dropped_strands,
        done.merged_vertices,
        done.resampled_strands
    );
    if !args.as_is {
        report.placement.reasons.iter().for_each(|r| println!("  {r}"));
    }
    report.placement.doubts.iter().filter(|_| !args.as_is).for_each(|d| println!("  in doubt: {d}"));
    encoded.notes.iter().for_each(|n| println!("  {n}"));
    if !report.followers.is_empty() {
        println!(
            "  the followers that the input asks for are left out; `tresses export` writes strands as they are drawn"
        );
    }
    Ok(())
}
