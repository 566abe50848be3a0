//! `tresses cards`: bakes a groom or a built-in style to textured cards.

use crate::{
    export::{RestingCharacter, drawn},
    files,
    progress::Preparing,
    say,
    settings_args::SettingsArgs,
};
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
    time::Instant,
};
use tresses::{
    groom::{
        Rig, TriMesh,
        cards::{self, CardAlpha, CardLook, CardOptions, Cards, SIZES},
    },
    light::fiber::bsdf::color_of,
};

/// Options of `tresses cards`.
#[derive(clap::Args, Debug)]
pub struct CardsArgs {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// Numbers of cards of the levels, falling
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "400,150,40")]
    pub levels: Vec<u32>,
    /// Edge of the textures, texels: a power of two from 128 to 8192
    #[arg(long, value_name = "N", default_value = "2048")]
    pub texture: u32,
    /// Number of different pictures of locks in the textures: with more, cards differ more, and texels are larger
    #[arg(long, value_name = "N", default_value = "32")]
    pub textures: u32,
    /// Largest numbers of triangles of the levels [default: 48 per card, then 32, then 12]
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub triangles: Vec<u32>,
    /// Drawing of partial coverage: core (an opaque core and a blended fringe), mask, or blend
    #[arg(long, value_name = "MODE", default_value = "core")]
    pub alpha: Alpha,
    /// File for the cards: .glb with the body and its skeleton, or .obj with a file for each level and textures beside
    #[arg(long, value_name = "FILE", default_value = "out/cards.glb")]
    pub out: PathBuf,
    /// File for the numbers of the bake (.json)
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
}

/// Values of --alpha.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub enum Alpha {
    /// An opaque core and a blended fringe.
    Core,
    /// Opaque from half coverage on.
    Mask,
    /// Blended.
    Blend,
}

impl From<Alpha> for CardAlpha {
    fn from(alpha: Alpha) -> Self {
        match alpha {
            Alpha::Core => Self::Core,
            Alpha::Mask => Self::Mask,
            Alpha::Blend => Self::Blend,
        }
    }
}

/// Exponent of the color of a mass of hair that gives the color of cards, whose light is scattered once. It makes the
/// four built-in pigments as bright as the Kajiya–Kay model, which was compared with a path tracer.
const ONE_LAYER: f32 = 0.55;

/// Runs `tresses cards`.
pub fn run(args: &CardsArgs) -> Result<()> {
    let options = CardOptions {
        levels: args.levels.clone(),
        texture: args.texture,
        textures: args.textures,
        triangles: args.triangles.clone(),
        ..Default::default()
    };
    options.check()?;
    let kind = FileKind::of(&args.out)?;
    let preset = args.settings.preset()?;
    let preparing = Preparing::new("opening the GPU");
    let RestingCharacter { scene, head, rig, .. } = RestingCharacter::new(&preset, &preparing)?;
    let strands = drawn(&scene, [&scene.character.hair().strands])?;
    let begin = Instant::now();
    let cards = pollster::block_on(cards::bake_with(&strands, head.as_ref(), &options, &preparing))?;
    let seconds = begin.elapsed().as_secs_f64();
    let fiber = preset.settings.material().fiber;
    let absorption = 0.5 * (fiber.root_absorption + fiber.tip_absorption);
    let color = color_of(absorption, fiber.shape.azimuthal).powf(ONE_LAYER);
    let look = CardLook { color, alpha: args.alpha.into() };
    let body = head.as_ref().map(|head| (head, rig.as_ref()));
    let mut written = kind.encoded(&cards, body, &look, &args.out)?;
    if let Some(path) = &args.report {
        let report = serde_json::to_vec_pretty(&numbers(&cards, strands.len(), seconds))?;
        written.push((path.clone(), report));
    }
    for (path, bytes) in &written {
        files::write(path, bytes)?;
    }
    drop(preparing);
    for (path, bytes) in &written {
        say!("{}: {:.1} MB", path.display(), bytes.len() as f64 / 1e6);
    }
    say!("{}", table(&cards));
    Ok(())
}

/// The format of --out.
#[derive(Clone, Copy)]
enum FileKind {
    Glb,
    Obj,
}

impl FileKind {
    fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("glb") => Ok(Self::Glb),
            Some("obj") => Ok(Self::Obj),
            _ => bail!("{}: cards can be written as .glb or .obj", path.display()),
        }
    }

    /// Returns all files with their paths.
    fn encoded(
        self,
        cards: &Cards,
        body: Option<(&TriMesh, Option<&Rig>)>,
        look: &CardLook,
        path: &Path,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>> {
        if matches!(self, Self::Glb) {
            return Ok(vec![(path.to_owned(), cards.glb(body, look)?)]);
        }
        let name = path.file_stem().and_then(|name| name.to_str()).context("--out has no valid file name")?;
        let files = cards.obj(name, look)?;
        Ok(files.into_iter().map(|(name, bytes)| (path.with_file_name(name), bytes)).collect())
    }
}

/// Returns the numbers of a bake.
fn numbers(cards: &Cards, strands: usize, seconds: f64) -> Value {
    let levels = cards.levels.iter().map(|level| {
        let accuracy = &level.accuracy;
        let differences = SIZES.iter().zip(accuracy.difference);
        let differences: Vec<_> = differences.map(|(px, mean)| json!({"px": px, "opacity": mean})).collect();
        json!({
            "cards": level.cards,
            "pictures": level.pictures,
            "vertices": level.mesh.positions.len(),
            "triangles": level.mesh.triangles.len(),
            "widening": level.widening,
            "softIou": accuracy.soft_iou,
            "silhouetteIou": accuracy.silhouette_iou,
            "coverage": accuracy.coverage,
            "coverageInOneView": accuracy.coverage_range,
            "difference": differences,
            "switchPx": accuracy.switch,
        })
    });
    json!({
        "strands": strands,
        "seconds": seconds,
        "texture": cards.textures.size,
        "texelMillimeters": 1000.0 / cards.density,
        "textureFilled": cards.filled,
        "levels": levels.collect::<Vec<_>>(),
        "notes": cards.notes,
    })
}

/// Formats the numbers of a bake as a table.
fn table(cards: &Cards) -> String {
    let mut text = String::from(
        "cards  pictures  triangles  widening  soft IoU  silhouette  coverage  in one view  below px\n",
    );
    for level in &cards.levels {
        let accuracy = &level.accuracy;
        let [low, high] = accuracy.coverage_range.map(|ratio| 100.0 * ratio);
        let _ = writeln!(
            text,
            "{:5}  {:8}  {:9}  {:8.2}  {:8.3}  {:10.3}  {:6.1} %  {low:3.0} to {high:3.0} %  {:8.0}",
            level.cards,
            level.pictures,
            level.mesh.triangles.len(),
            level.widening,
            accuracy.soft_iou,
            accuracy.silhouette_iou,
            100.0 * accuracy.coverage,
            accuracy.switch,
        );
    }
    let _ = write!(
        text,
        "textures: {0} × {0}, {1:.2} mm per texel, {2:.0} % filled",
        cards.textures.size,
        1000.0 / cards.density,
        100.0 * cards.filled
    );
    for note in &cards.notes {
        let _ = write!(text, "\nnote: {note}");
    }
    text
}
