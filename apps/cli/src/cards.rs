//! `tresses cards`: bakes a groom or a built-in style to textured cards.

use crate::{
    export::{RestingCharacter, colored},
    files,
    progress::TaskProgress,
    say,
    settings_args::SettingsArgs,
};
use anyhow::{Context, Result, ensure};
use std::{fmt::Write, path::PathBuf, time::Instant};
use tresses::groom::{
    Progress, Rig,
    cards::{CardAlpha, CardOptions, Cards, bake_with},
};
use tresses_scene::cards::{self, CardClip, CardFormat, LevelRequest};

/// Options of `tresses cards`.
#[derive(clap::Args, Debug)]
pub struct CardsArgs {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// Numbers of cards of the levels, falling; `helmet` at the end adds an opaque shell for heads of few pixels
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "400,150,40")]
    pub levels: Vec<LevelRequest>,
    /// Edge of the textures, texels: a power of two from 128 to 8192
    #[arg(long, value_name = "N", default_value = "2048")]
    pub texture: u32,
    /// Number of different pictures of locks, shared out over the levels: with more, cards differ more, and texels are
    /// larger
    #[arg(long, value_name = "N", default_value = "32")]
    pub textures: u32,
    /// Largest numbers of triangles of the levels [default: 48 per card, then 32, then 12; 480 for a helmet]
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub triangles: Vec<u32>,
    /// Number of chains of bones that carry the cards: for spring bones of engines, and for --simulate
    #[arg(long, value_name = "N", default_value = "0")]
    pub bones: u32,
    /// Simulate the hair in these animations of the body (all: in every one), and write the motion of the bones to a
    /// .glb
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub simulate: Vec<String>,
    /// Drawing of partial coverage in a .glb: core (an opaque core and a blended fringe), mask, or blend
    #[arg(long, value_name = "MODE", default_value = "core")]
    pub alpha: Alpha,
    /// Write a .glb for each level, for engines that do not read levels of one file
    #[arg(long)]
    pub split: bool,
    /// Also write the textures as .ktx2 with mip levels; with --alpha mask, their coverage keeps its area
    #[arg(long)]
    pub ktx2: bool,
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

/// Runs `tresses cards`.
pub fn run(args: &CardsArgs) -> Result<()> {
    let options = CardOptions {
        texture_size: args.texture,
        lock_texture_count: args.textures,
        triangles: args.triangles.clone(),
        chain_count: args.bones,
        ..cards::options(&args.levels)?
    };
    options.check()?;
    let format = CardFormat::of(&args.out, args.split)?;
    ensure!(
        !args.split || format == CardFormat::SplitGlb,
        "--split is for .glb files; .obj files are split anyway"
    );
    ensure!(
        args.simulate.is_empty() || (args.bones > 0 && format != CardFormat::Obj),
        "--simulate needs --bones and a .glb file"
    );
    ensure!(args.report.as_ref() != Some(&args.out), "--report and --out are the same file");
    for path in args.report.iter().chain([&args.out]) {
        files::prepare(path)?;
    }
    let preset = args.settings.preset()?;
    let preparing = TaskProgress::new("opening the GPU");
    let RestingCharacter { mut scene, head, rig, .. } = RestingCharacter::new(&preset, &preparing)?;
    let strands = colored(&scene)?;
    let begin = Instant::now();
    let baked = pollster::block_on(bake_with(&strands, head.as_ref(), &options, &preparing))?;
    let seconds = begin.elapsed().as_secs_f64();
    let mut look = cards::look(&preset.settings, args.alpha.into());
    if !args.simulate.is_empty() {
        let rig = rig.as_ref().filter(|rig| !rig.animations.is_empty());
        let rig = rig.context("--simulate needs a body with animations (.glb, .usd)")?;
        let built_in = preset.source.grooms.is_empty();
        let requested = animations(rig, &args.simulate)?;
        for (done, animation) in requested.iter().enumerate() {
            pollster::block_on(preparing.step("simulating the hair", done as f32 / requested.len() as f32));
            let clip = CardClip { rig, animation: *animation, built_in };
            look.motions.push(cards::simulate(&mut scene, &baked.chains, clip)?);
        }
    }
    let body = head.as_ref().map(|head| (head, rig.as_ref()));
    let mut written = format.encoded(&baked, body, &look, &args.out)?;
    if args.ktx2 {
        written.extend(cards::ktx2(&baked, args.alpha.into(), &args.out)?);
    }
    if let Some(path) = &args.report {
        let mut report = cards::numbers(&baked, strands.len());
        report["seconds"] = seconds.into();
        written.push((path.clone(), serde_json::to_vec_pretty(&report)?));
    }
    for (path, bytes) in &written {
        files::write(path, bytes)?;
    }
    drop(preparing);
    for (path, bytes) in &written {
        say!("{}: {:.2} MB", path.display(), bytes.len() as f64 / 1e6);
    }
    say!("{}", table(&baked));
    Ok(())
}

/// Returns the indices of the animations of `rig` with these names, whatever their case, or of all.
fn animations(rig: &Rig, names: &[String]) -> Result<Vec<usize>> {
    if names == ["all"] {
        return Ok((0..rig.animations.len()).collect());
    }
    let find = |name: &String| {
        let found = rig.animations.iter().position(|animation| animation.name.eq_ignore_ascii_case(name));
        found.with_context(|| {
            let available: Vec<_> = rig.animations.iter().map(|animation| animation.name.as_str()).collect();
            format!("the body has no animation {name:?}; it has {}", available.join(", "))
        })
    };
    names.iter().map(find).collect()
}

/// Formats the numbers of a bake as a table.
fn table(cards: &Cards) -> String {
    let mut text = String::from(
        " cards  pictures  triangles  widening  soft IoU  silhouette  coverage  in one view  below px\n",
    );
    for level in &cards.levels {
        let accuracy = &level.accuracy;
        let [low, high] = accuracy.coverage_range.map(|ratio| 100.0 * ratio);
        let name = if level.helmet { "helmet".into() } else { level.cards.to_string() };
        let below = if accuracy.switch > 0.0 { format!("{:.0}", accuracy.switch) } else { "never".into() };
        let _ = writeln!(
            text,
            "{name:>6}  {:8}  {:9}  {:8.2}  {:8.3}  {:10.3}  {:6.1} %  {low:3.0} to {high:3.0} %  {below:>8}",
            level.pictures,
            level.mesh.triangles.len(),
            level.widening,
            accuracy.soft_iou,
            accuracy.silhouette_iou,
            100.0 * accuracy.coverage,
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
