//! `tresses export`: writes the strands of a groom or a built-in style as drawn at rest.

use crate::{files, progress::TaskProgress, say, settings_args::SettingsArgs};
use anyhow::{Result, ensure};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};
use tresses::{
    Gesture, Gpu, LodMode, LodOptions,
    groom::{
        Guides, Rig, Strands, TriMesh,
        export::{ExportHair, Writer},
        formats::{self, ContentKind, WRITTEN},
        orient::LengthUnit,
    },
    low_level::StrandBuffers,
};
use tresses_scene::{CompanionFiles, Preset, Scene, Shelf, motion};

/// Options of `tresses export`.
#[derive(clap::Args, Debug)]
pub struct ExportArgs {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// File for the strands
    #[arg(long, value_name = "FILE", help = out_help())]
    pub out: PathBuf,
    /// File for brows, lashes and beard of the built-in character
    #[arg(long, value_name = "FILE")]
    pub face_out: Option<PathBuf>,
    /// Compress the .glb of --out (EXT_meshopt_compression): smaller, but readers without that extension cannot open it
    #[arg(long)]
    pub packed: bool,
    /// File for the body
    #[arg(long, value_name = "FILE", help = head_help())]
    pub head_out: Option<PathBuf>,
}

/// Runs `tresses export`.
pub fn run(args: &ExportArgs) -> Result<()> {
    let writer = Writer::of(&args.out)?;
    let face_writer = args.face_out.as_deref().map(Writer::of).transpose()?;
    let head_writer =
        args.head_out.as_deref().map(|path| Writer::holding(path, ContentKind::Mesh)).transpose()?;
    ensure!(!args.packed || writer.compresses, "only .glb files can be compressed: remove --packed");
    let preset = args.settings.preset()?;
    let preparing = TaskProgress::new("opening the GPU");
    let RestingCharacter { scene, head, rig, .. } = RestingCharacter::new(&preset, &preparing)?;
    ensure!(args.head_out.is_none() || head.is_some(), "this hair has no body: remove --head-out");
    let strands = colored(&scene)?;
    let body = head.as_ref().map(|head| (head, rig.as_ref()));
    let character_bytes = match writer.holds(ContentKind::Rig) {
        true => {
            let look = scene.look(&preset.settings);
            let hair =
                [ExportHair { name: "hair", strands: &strands, packed: args.packed, look: look.as_ref() }];
            Some(writer.character(body, &hair)?)
        }
        false => None,
    };
    let mut message = match character_bytes {
        Some(bytes) => {
            files::write(&args.out, &bytes)?;
            let body = head.as_ref().map(|head| format!(", a body of {} triangles", head.triangles.len()));
            counted(&args.out, &strands) + &body.unwrap_or_default()
        }
        None => write_strands(&args.out, writer, &strands)?,
    };
    if let (Some(path), Some(writer)) = (&args.face_out, face_writer) {
        let face = || scene.character.grooms().skip(1);
        ensure!(face().next().is_some(), "this character has no facial hair: remove --face-out");
        let all = face().map(|hair| &hair.strands);
        write!(message, "\n{}", write_strands(path, writer, &drawn_strands(&scene, all)?)?)?;
    }
    if let (Some(path), Some(writer), Some(head)) = (&args.head_out, head_writer, &head) {
        write!(message, "\n{}", write_body(path, writer, head, rig.as_ref())?)?;
    }
    drop(preparing);
    say!("{message}");
    Ok(())
}

/// A character at rest with all its strands, whatever their level of detail.
pub struct RestingCharacter {
    /// Hair and body on the GPU.
    pub scene: Scene,
    /// The body.
    pub head: Option<TriMesh>,
    /// The body's rig; that of the built-in character has the built-in motions as animations.
    pub rig: Option<Rig>,
    /// Rest poses of the guides.
    pub guides: Guides,
}

impl RestingCharacter {
    /// Opens the GPU, and the character of `preset`.
    pub fn new(preset: &Preset, preparing: &TaskProgress) -> Result<Self> {
        preset.settings.check()?;
        let gpu = pollster::block_on(Gpu::open())?;
        let character = pollster::block_on(preset.character(&gpu.context, preparing))?;
        let (head, guides) = (character.head.clone(), character.groom.guides.clone());
        let rig = motion::animation::rig_of(&character, preset.source.is_mannequin());
        let colliders = CompanionFiles::of(&preset.source, Shelf::default()).colliders()?;
        let quality = preset.settings.quality([16, 16], 1)?;
        let scene = Scene::new(gpu, character, colliders, &preset.settings, &quality, preparing);
        let mut scene = pollster::block_on(scene)?;
        scene.apply(&preset.settings)?;
        scene.set_lod(LodOptions { mode: LodMode::Off, ..Default::default() })?;
        scene.reset(&Gesture::default())?;
        Ok(Self { scene, head, rig, guides })
    }
}

fn out_help() -> String {
    let rig_formats = formats::listed(&formats::written(ContentKind::Rig), "and");
    format!(
        "File for the strands, whose extension ({}) selects the format; {rig_formats} also store the body and its skeleton",
        formats::listed(WRITTEN, "or")
    )
}

fn head_help() -> String {
    let (all, rigs) = (formats::written(ContentKind::Mesh), formats::written(ContentKind::Rig));
    let [all, rigs] = [(&all, "or"), (&rigs, "and")].map(|(list, joint)| formats::listed(list, joint));
    format!("File for the body ({all}); {rigs} also store its skeleton")
}

/// Writes a body, with its rig where the format holds one. Returns a description of the file.
pub fn write_body(path: &Path, writer: &Writer, body: &TriMesh, rig: Option<&Rig>) -> Result<String> {
    files::write(path, &writer.mesh(body, rig)?)?;
    let mut message = format!("{}: {} triangles", path.display(), body.triangles.len());
    if let Some(rig) = rig.filter(|_| writer.holds(ContentKind::Rig)) {
        let (joints, shapes) = (rig.joints.len(), rig.targets.len());
        write!(message, ", {joints} joints, {shapes} blend shapes, {} animations", rig.animations.len())?;
    }
    Ok(message)
}

/// Writes `strands`. Returns a description of the file.
pub fn write_strands(path: &Path, writer: &Writer, strands: &Strands) -> Result<String> {
    let encoded = writer.strands(strands, Some(LengthUnit(1.0)))?;
    files::write(path, &encoded.bytes)?;
    let mut message = counted(path, strands);
    for note in &encoded.notes {
        write!(message, "\n  {note}")?;
    }
    Ok(message)
}

/// Describes a file of strands.
fn counted(path: &Path, strands: &Strands) -> String {
    format!("{}: {} strands, {} vertices", path.display(), strands.len(), strands.positions.len())
}

/// Returns the hair's strands as [`drawn_strands`], with their colors.
pub fn colored(scene: &Scene) -> Result<Strands> {
    let hair = &scene.character.hair().strands;
    let mut strands = drawn_strands(scene, [hair])?;
    strands.colors = pollster::block_on(scene.drawn_colors(hair))?;
    Ok(strands)
}

/// Returns the strands of `all` as `scene` draws them now. Blocks.
pub fn drawn_strands<'a>(scene: &Scene, all: impl IntoIterator<Item = &'a StrandBuffers>) -> Result<Strands> {
    pollster::block_on(scene.drawn(all))
}
