//! `tresses export`: the strands of a groom or a built-in style as they are drawn at rest, for other programs.

use crate::{files, progress::Preparing, say, settings_args::SettingsArgs};
use anyhow::{Result, ensure};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};
use tresses::{
    character::Gesture,
    gpu::Gpu,
    groom::{
        Strands,
        export::{Hair, Writer},
        formats::{self, Content, WRITTEN},
        orient::Unit,
    },
    lod::{LodMode, LodOptions},
    strands::StrandBuffers,
};
use tresses_scene::{Companions, Scene, Shelf, motion};

/// The options of `tresses export`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// The file for the strands
    #[arg(long, value_name = "FILE", help = out_help())]
    pub out: PathBuf,
    /// A file for brows, lashes and beard of the built-in character, as for the strands
    #[arg(long, value_name = "FILE")]
    pub face_out: Option<PathBuf>,
    /// Compress the .glb of --out (EXT_meshopt_compression): smaller, but what cannot read that opens nothing of it
    #[arg(long)]
    pub packed: bool,
    /// A file for the body
    #[arg(long, value_name = "FILE", help = head_help())]
    pub head_out: Option<PathBuf>,
}

/// Runs `tresses export`.
pub fn run(args: &Args) -> Result<()> {
    let writer = Writer::of(&args.out)?;
    let face_writer = args.face_out.as_deref().map(Writer::of).transpose()?;
    let head_writer =
        args.head_out.as_deref().map(|path| Writer::holding(path, Content::Mesh)).transpose()?;
    ensure!(!args.packed || writer.compresses, "only a .glb is compressed: leave --packed out");
    let preset = args.settings.preset()?;
    preset.settings.check()?;
    let preparing = Preparing::new("opening the GPU");
    let gpu = pollster::block_on(Gpu::open())?;
    let character = pollster::block_on(preset.character(&gpu.context, &preparing))?;
    let head = character.head.clone();
    let rig = character.anatomy.as_ref().map(|anatomy| {
        let mut rig = anatomy.rig.clone();
        if preset.source.grooms.is_empty() {
            rig.animations = motion::animation::of_the_character(&rig);
        }
        rig
    });
    ensure!(
        args.head_out.is_none() || head.is_some(),
        "nothing is drawn with this hair: leave --head-out out"
    );
    let colliders = Companions::of(&preset.source, Shelf::default()).colliders()?;
    let (physics, quality) = (preset.settings.physics(), preset.settings.quality([16, 16], 1)?);
    let scene = Scene::new(gpu, character, colliders, &physics, &quality, &preparing);
    let mut scene = pollster::block_on(scene)?;
    scene.apply(&preset.settings)?;
    // All of it, however far away.
    scene.set_lod(LodOptions { mode: LodMode::Off, ..Default::default() })?;
    scene.reset(&Gesture::default())?;
    let strands = drawn(&scene, [&scene.character.hair().strands])?;
    let body = head.as_ref().map(|head| (head, rig.as_ref()));
    let whole = match writer.holds(Content::Rig) {
        true => {
            let look = scene.look(&preset.settings);
            let hair = [Hair { name: "hair", strands: &strands, packed: args.packed, look: look.as_ref() }];
            Some(writer.character(body, &hair)?)
        }
        false => None,
    };
    let mut said = match whole {
        Some(bytes) => {
            files::write(&args.out, &bytes)?;
            let body = head.as_ref().map(|head| format!(", a body of {} triangles", head.triangles.len()));
            counted(&args.out, &strands) + &body.unwrap_or_default()
        }
        None => write_strands(&args.out, writer, &strands)?,
    };
    if let (Some(path), Some(writer)) = (&args.face_out, face_writer) {
        let face = || scene.character.grooms().skip(1);
        ensure!(face().next().is_some(), "nothing grows on this face: leave --face-out out");
        let all = face().map(|hair| &hair.strands);
        write!(said, "\n{}", write_strands(path, writer, &drawn(&scene, all)?)?)?;
    }
    if let (Some(path), Some(writer), Some(head)) = (&args.head_out, head_writer, &head) {
        write!(said, "\n{}: {} triangles", path.display(), head.triangles.len())?;
        files::write(path, &writer.mesh(head, rig.as_ref())?)?;
        if let Some(rig) = rig.as_ref().filter(|_| writer.holds(Content::Rig)) {
            let (joints, shapes) = (rig.joints.len(), rig.targets.len());
            write!(said, ", {joints} joints, {shapes} shapes, {} animations", rig.animations.len())?;
        }
    }
    drop(preparing);
    say!("{said}");
    Ok(())
}

fn out_help() -> String {
    let whole = formats::listed(&formats::written(Content::Rig), "and");
    format!(
        "The file for the strands, whose extension ({}) decides the format; {whole} also hold what is drawn with the hair, and what bends it",
        formats::listed(WRITTEN, "or")
    )
}

fn head_help() -> String {
    let (all, rigs) = (formats::written(Content::Mesh), formats::written(Content::Rig));
    let [all, rigs] = [(&all, "or"), (&rigs, "and")].map(|(list, joint)| formats::listed(list, joint));
    format!("A file for what is drawn with the hair ({all}); {rigs} also hold what bends it")
}

/// Writes `strands`; what was written, in words.
fn write_strands(path: &Path, writer: &Writer, strands: &Strands) -> Result<String> {
    let encoded = writer.strands(strands, Some(Unit(1.0)))?;
    files::write(path, &encoded.bytes)?;
    let mut said = counted(path, strands);
    for note in &encoded.notes {
        write!(said, "\n  {note}")?;
    }
    Ok(said)
}

/// What was written where.
fn counted(path: &Path, strands: &Strands) -> String {
    format!("{}: {} strands, {} vertices", path.display(), strands.len(), strands.positions.len())
}

/// The strands of `all` that `scene` draws now. Blocks.
pub fn drawn<'a>(scene: &Scene, all: impl IntoIterator<Item = &'a StrandBuffers>) -> Result<Strands> {
    pollster::block_on(scene.drawn(all))
}
