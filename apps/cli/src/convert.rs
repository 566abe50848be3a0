//! `tresses convert`: converts grooms between formats.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use tresses::groom::{
    export::{EncodedFile, ExportHair, Writer},
    formats::{self, ContentKind, GROOMS, WRITTEN},
    import::{self, ImportOptions},
    orient::{Axis, LengthUnit, OrientationOverride},
};

use tresses::{CharacterFiles, CharacterSource};
use tresses_scene::knobs::{self, Value};

use crate::{
    files,
    orient_args::{MomentArgs, OrientArgs},
    progress::TaskProgress,
};

/// Convert grooms into other formats, in meters, Y up, face towards +Z; or cook a groom with its head (.tresses), which
/// then opens without further processing.
#[derive(clap::Args)]
#[command(override_usage = "tresses convert [OPTIONS] <IN>... <OUT>")]
pub struct ConvertArgs {
    // A single list, because clap would not allow options between two.
    #[arg(required = true, value_name = "FILE", help = files_help())]
    files: Vec<PathBuf>,
    /// Mesh that the groom grows on, to orient the groom; .glb and .tresses files also include it
    #[arg(long, value_name = "MESH")]
    head: Vec<PathBuf>,
    /// Keep unit and axes of the input
    #[arg(long)]
    as_is: bool,
    /// Unit of the file to write, Alembic and USD only: cm for Unreal and Maya [default: m]
    #[arg(long, value_name = "UNIT", conflicts_with = "as_is")]
    out_unit: Option<LengthUnit>,
    /// Diameter of all strands, such as 80um, instead of the widths in the files
    #[arg(long, value_name = "LENGTH", value_parser = diameter, conflicts_with = "as_is")]
    width: Option<f32>,
    /// Compress a .glb (EXT_meshopt_compression): smaller, but readers without that extension cannot open it
    #[arg(long, conflicts_with = "as_is")]
    packed: bool,
    #[command(flatten)]
    moment: MomentArgs,
    #[command(flatten)]
    orient: OrientArgs,
}

/// Parses a strand's diameter, and returns it in meters.
fn diameter(text: &str) -> Result<f32, String> {
    let knob = knobs::find("style.width").expect("a row of the table");
    match knob.parse(text) {
        Ok(Value::Number(diameter)) => Ok(diameter),
        _ => Err(format!("the width must be {}", knob.range())),
    }
}

fn files_help() -> String {
    let [read, written] = [GROOMS, WRITTEN].map(|list| formats::listed(list, "or"));
    format!(
        "Groom files to read ({read}), joined into one; the last is the file to write, whose extension ({written}, or .tresses to cook) selects the format"
    )
}

/// Runs the command.
pub fn run(args: ConvertArgs) -> anyhow::Result<()> {
    let Some((output, inputs)) = args.files.split_last().filter(|(_, inputs)| !inputs.is_empty()) else {
        bail!("convert needs at least one file to read and one to write");
    };
    let mut options = args.orient.options();
    options.moment = args.moment.moment();
    if formats::is_cooked(output) {
        ensure!(
            !args.as_is && !args.packed,
            "a cooked groom is in meters and not compressed: remove --as-is and --packed"
        );
        ensure!(args.out_unit.is_none(), "a cooked groom is in meters: remove --out-unit");
        ensure!(args.width.is_none(), "a cooked groom keeps the widths of its files: remove --width");
        return cook(inputs, &args.head, &options, output);
    }
    let writer = Writer::of(output)?;
    if args.as_is {
        options.orient = OrientationOverride {
            unit: Some(LengthUnit(1.0)),
            up: Some(Axis::Y),
            front: Some(Axis::Z),
            is_mirrored: Some(false),
        };
        // With an unknown unit, lengths cannot be checked.
        options.skips_repair = true;
    }
    ensure!(!args.packed || writer.compresses, "only .glb files can be compressed: remove --packed");
    let (mut strands, head, report) = if args.as_is {
        let (strands, report) = import::read(inputs, &options)?;
        (strands, None, report)
    } else {
        import::read_complete(inputs, &args.head, &options)?
    };
    if let Some(diameter) = args.width {
        strands.radii = vec![0.5 * diameter; strands.positions.len()];
    }
    // Formats that store a hair material also get the body.
    let includes_body = writer.holds(ContentKind::Look) && !args.as_is && args.out_unit.is_none();
    let encoded = if includes_body {
        let body = head.as_ref().map(|head| (head, report.rig.as_ref()));
        let look = report.look.as_ref();
        let hair = ExportHair { name: "hair", strands: &strands, packed: args.packed, look };
        EncodedFile::from(writer.character(body, &[hair])?)
    } else {
        writer.strands(&strands, args.out_unit.or((!args.as_is).then_some(LengthUnit(1.0))))?
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
    if let Some(head) = head.filter(|_| includes_body) {
        println!("  with its body of {} triangles", head.triangles.len());
    }
    if !args.as_is {
        report.placement.reasons.iter().for_each(|r| println!("  {r}"));
    }
    let of_head = report.head_placement.iter().flat_map(|placement| &placement.doubts);
    report
        .placement
        .doubts
        .iter()
        .chain(of_head)
        .filter(|_| !args.as_is)
        .for_each(|d| println!("  uncertain: {d}"));
    encoded.notes.iter().for_each(|n| println!("  {n}"));
    if !report.followers.is_empty() {
        println!(
            "  interpolated strands that the input requests are not written; `tresses export` writes all drawn strands"
        );
    }
    Ok(())
}

/// Writes a cooked groom: everything that opening the groom on its head computes.
fn cook(grooms: &[PathBuf], heads: &[PathBuf], options: &ImportOptions, out: &Path) -> anyhow::Result<()> {
    let preparing = TaskProgress::new("reading the groom");
    let base = pollster::block_on(CharacterSource::imported(
        &CharacterFiles::Disk { grooms, heads },
        options,
        &preparing,
    ))?;
    let cooked = base.cook()?.context("only grooms from files can be cooked")?;
    let bytes = cooked.write()?;
    files::write(out, &bytes)?;
    drop(preparing);
    let (strands, guides) = (cooked.strands.len(), cooked.groom.guides.len());
    let head = cooked.head.map(|head| format!(", a head of {} triangles", head.triangles.len()));
    let (head, size) = (head.unwrap_or_default(), bytes.len() as f64 / 1e6);
    println!("{}: {strands} strands on {guides} guides{head}, {size:.1} MB", out.display());
    base.notes().for_each(|note| println!("  uncertain: {note}"));
    println!("  only for this version of Tresses: keep the source files");
    Ok(())
}
