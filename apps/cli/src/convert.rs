//! `tresses convert`: grooms from one format into another.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use tresses::groom::{
    export::{Encoded, Hair, Writer},
    formats::{self, Content, GROOMS, WRITTEN},
    import::{self, ImportOptions},
    orient::{Axis, Choice, Unit},
};

use tresses::character::{CharacterFiles, CharacterSource};

use crate::{
    files,
    orient_args::{MomentArgs, OrientArgs},
    progress::Preparing,
};

/// Convert grooms into other formats, in metres, Y up, face towards +Z; or cook one with its head (.tresses), which then
/// opens at once.
#[derive(clap::Args)]
#[command(override_usage = "tresses convert [OPTIONS] <IN>... <OUT>")]
pub struct Args {
    // One list, since two would forbid options between them.
    #[arg(required = true, value_name = "FILE", help = files_help())]
    files: Vec<PathBuf>,
    /// The mesh that the groom grows on, to orient it by; a .glb and a .tresses get it, too.
    #[arg(long, value_name = "MESH")]
    head: Vec<PathBuf>,
    /// Keep unit and axes of the input.
    #[arg(long)]
    as_is: bool,
    /// The unit of the file to write, Alembic and USD only: cm for Unreal and Maya [default: m]
    #[arg(long, value_name = "UNIT", conflicts_with = "as_is")]
    out_unit: Option<Unit>,
    /// Compress a .glb (EXT_meshopt_compression): smaller, but what cannot read that opens nothing of it
    #[arg(long, conflicts_with = "as_is")]
    packed: bool,
    #[command(flatten)]
    moment: MomentArgs,
    #[command(flatten)]
    orient: OrientArgs,
}

fn files_help() -> String {
    let [read, written] = [GROOMS, WRITTEN].map(|list| formats::listed(list, "or"));
    format!(
        "Groom files ({read}), several are joined; the last one is the file to write, whose extension ({written}, or .tresses for a cooked one) decides the format"
    )
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let Some((output, inputs)) = args.files.split_last().filter(|(_, inputs)| !inputs.is_empty()) else {
        bail!("convert needs at least one file to read and one to write");
    };
    let mut options = args.orient.options();
    options.moment = args.moment.moment();
    if formats::is_cooked(output) {
        ensure!(
            !args.as_is && !args.packed,
            "a cooked groom is in metres and not compressed: leave the option out"
        );
        ensure!(args.out_unit.is_none(), "a cooked groom is in metres: leave --out-unit out");
        return cook(inputs, &args.head, &options, output);
    }
    let writer = Writer::of(output)?;
    if args.as_is {
        options.orient =
            Choice { unit: Some(Unit(1.0)), up: Some(Axis::Y), front: Some(Axis::Z), mirror: Some(false) };
        // Lengths in an unknown unit cannot be called too short.
        options.unrepaired = true;
    }
    ensure!(!args.packed || writer.compresses, "only a .glb is compressed: leave --packed out");
    let (strands, head, report) = if args.as_is {
        let (strands, report) = import::read(inputs, &options)?;
        (strands, None, report)
    } else {
        import::read_whole(inputs, &args.head, &options)?
    };
    // A file that holds the material of the hair gets the body, too.
    let whole = writer.holds(Content::Look) && !args.as_is && args.out_unit.is_none();
    let encoded = if whole {
        let body = head.as_ref().map(|head| (head, report.rig.as_ref()));
        let look = report.look.as_ref();
        let hair = Hair { name: "hair", strands: &strands, packed: args.packed, look };
        Encoded::from(writer.character(body, &[hair])?)
    } else {
        writer.strands(&strands, args.out_unit.or((!args.as_is).then_some(Unit(1.0))))?
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
    if let Some(head) = head.filter(|_| whole) {
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
        .for_each(|d| println!("  in doubt: {d}"));
    encoded.notes.iter().for_each(|n| println!("  {n}"));
    if !report.followers.is_empty() {
        println!(
            "  the followers that the input asks for are left out; `tresses export` writes strands as they are drawn"
        );
    }
    Ok(())
}

/// Writes all that opening a groom on its head computes.
fn cook(grooms: &[PathBuf], heads: &[PathBuf], options: &ImportOptions, out: &Path) -> anyhow::Result<()> {
    let preparing = Preparing::new("reading the groom");
    let base = pollster::block_on(CharacterSource::imported(
        &CharacterFiles::Disk { grooms, heads },
        options,
        &preparing,
    ))?;
    let cooked = base.cook()?.context("only grooms of files are cooked")?;
    let bytes = cooked.write()?;
    files::write(out, &bytes)?;
    drop(preparing);
    let (strands, guides) = (cooked.strands.len(), cooked.groom.guides.len());
    let head = cooked.head.map(|head| format!(", a head of {} triangles", head.triangles.len()));
    let (head, size) = (head.unwrap_or_default(), bytes.len() as f64 / 1e6);
    println!("{}: {strands} strands on {guides} guides{head}, {size:.1} MB", out.display());
    base.notes().for_each(|note| println!("  in doubt: {note}"));
    println!("  for this version of Tresses: keep what it was made of");
    Ok(())
}
