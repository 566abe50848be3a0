//! `tresses export`: the strands of a groom or a built-in style as they are drawn at rest, for other programs.

use crate::{files, load, progress::Preparing, say, settings_args::SettingsArgs};
use anyhow::{Result, ensure};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
    sync::Arc,
};
use tresses::{
    Pipelines,
    gpu::Gpu,
    groom::{
        Strands, TriMesh,
        export::{self, Format, glb, usda},
        formats,
    },
    lod::{LodMode, LodOptions},
    strands::StrandBuffers,
};
use tresses_scene::{Companions, Gesture, Scene, Shelf, motion};

/// The options of `tresses export`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// The file for the strands, whose extension (.hair, .tfx, .obj, .data, .ply, .glb, .abc, .usda, .usdc) decides the
    /// format; .glb, .usda and .usdc also have what is drawn with the hair, and what bends it
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// A file for brows, lashes and beard of the built-in character, as for the strands
    #[arg(long, value_name = "FILE")]
    pub face_out: Option<PathBuf>,
    /// Compress the .glb of --out (EXT_meshopt_compression): smaller, but what cannot read that opens nothing of it
    #[arg(long)]
    pub packed: bool,
    /// A file for what is drawn with the hair: .obj, or .glb, .usda, .usdc, which also have what bends it
    #[arg(long, value_name = "FILE")]
    pub head_out: Option<PathBuf>,
}

/// Runs `tresses export`.
pub fn run(args: &Args) -> Result<()> {
    let format = Format::of(&args.out)?;
    let face_format = args.face_out.as_deref().map(Format::of).transpose()?;
    let head_extension = args.head_out.as_deref().map(formats::extension).unwrap_or_default();
    let is_known = matches!(&*head_extension, "obj" | "glb" | "usda" | "usdc");
    ensure!(args.head_out.is_none() || is_known, "a head is written as .obj, .glb, .usda or .usdc");
    ensure!(!args.packed || format == Format::Glb, "only a .glb is compressed: leave --packed out");
    let preset = args.settings.preset()?;
    preset.settings.check()?;
    let preparing = Preparing::new("opening the GPU");
    let gpu = pollster::block_on(Gpu::open())?;
    let pipelines = Arc::new(Pipelines::new(&gpu.device));
    let character = load::load(&preset, &gpu, &pipelines.simulate, &preparing)?;
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
    let scene = Scene::new(gpu, pipelines, character, colliders, &physics, &quality, &preparing);
    let mut scene = pollster::block_on(scene)?;
    scene.apply(&preset.settings)?;
    // All of it, however far away.
    scene.set_lod(LodOptions { mode: LodMode::Off, ..Default::default() })?;
    scene.reset(&Gesture::default())?;
    let strands = drawn(&scene, [&scene.hair.strands])?;
    let body = head.as_ref().map(|head| (head, rig.as_ref()));
    let whole = match format {
        Format::Glb => {
            let look = scene.look(&preset.settings);
            let look = look.as_ref();
            let hair = [glb::Hair { name: "hair", strands: &strands, packed: args.packed, look }];
            Some(glb::character(body, &hair)?)
        }
        Format::Usda | Format::Usdc => {
            let hair = [usda::HairOf { name: "hair", strands: &strands }];
            Some(of_usd(format == Format::Usdc, usda::character(body, &hair)?)?)
        }
        _ => None,
    };
    let mut said = match whole {
        Some(bytes) => {
            files::write(&args.out, &bytes)?;
            let body = head.as_ref().map(|head| format!(", a body of {} triangles", head.triangles.len()));
            counted(&args.out, &strands) + &body.unwrap_or_default()
        }
        None => write_strands(&args.out, format, &strands)?,
    };
    if let (Some(path), Some(format)) = (&args.face_out, face_format) {
        ensure!(!scene.face.is_empty(), "nothing grows on this face: leave --face-out out");
        let all = scene.face.iter().map(|face| &face.hair.strands);
        write!(said, "\n{}", write_strands(path, format, &drawn(&scene, all)?)?)?;
    }
    if let (Some(path), Some(head)) = (&args.head_out, &head) {
        write!(said, "\n{}: {} triangles", path.display(), head.triangles.len())?;
        let bytes = match &*head_extension {
            "obj" => obj(head).into_bytes(),
            "glb" => glb::body(head, rig.as_ref())?,
            usd => of_usd(usd == "usdc", usda::character(Some((head, rig.as_ref())), &[])?)?,
        };
        files::write(path, &bytes)?;
        if let Some(rig) = rig.as_ref().filter(|_| head_extension != "obj") {
            let (joints, shapes) = (rig.joints.len(), rig.targets.len());
            write!(said, ", {joints} joints, {shapes} shapes, {} animations", rig.animations.len())?;
        }
    }
    drop(preparing);
    say!("{said}");
    Ok(())
}

/// A text of USD as it is, or packed.
fn of_usd(packed: bool, text: Vec<u8>) -> Result<Vec<u8>> {
    Ok(if packed { usda::packed(&text)? } else { text })
}

/// Writes `strands`; what was written, in words.
fn write_strands(path: &Path, format: Format, strands: &Strands) -> Result<String> {
    let encoded = export::encode(strands, format, true)?;
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

/// A mesh as an OBJ file.
fn obj(mesh: &TriMesh) -> String {
    let mut text = String::from("# metres, Y up, face +Z\n");
    let lines = [("v", &mesh.positions), ("vn", &mesh.normals)];
    for (key, values) in lines {
        values.iter().for_each(|v| text.push_str(&format!("{key} {} {} {}\n", v.x, v.y, v.z)));
    }
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| i + 1);
        text.push_str(&format!("f {a}//{a} {b}//{b} {c}//{c}\n"));
    }
    text
}
