//! `tresses bake`: simulated hair as an Alembic or USD cache, for programs that play it back.

use crate::{export::drawn, files, load, progress, progress::Preparing, say, settings_args::SettingsArgs};
use anyhow::{Result, ensure};
use std::{
    io::{Seek, Write},
    path::PathBuf,
    sync::Arc,
};
use tresses::{
    Pipelines,
    glam::Vec3,
    gpu::Gpu,
    groom::{
        export::{abc, usda},
        formats,
        orient::Unit,
    },
    lod::{LodMode, LodOptions},
};
use tresses_scene::{Companions, Motion, Scene, Shelf};

/// The longest cache, frames.
const MAX_FRAMES: i64 = 100_000;

/// The options of `tresses bake`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// How the character moves: still, nod, turn, shake, walk, dance, or a keyframe file (.json)
    #[arg(long, value_name = "NAME", default_value = "still")]
    pub motion: String,
    /// Frames to simulate and to write [default: one period of the motion]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_FRAMES))]
    pub frames: Option<u32>,
    /// Frames per second
    #[arg(long, value_name = "F", default_value = "24", value_parser = crate::args::fps)]
    pub fps: f64,
    /// The unit of the file: cm for Unreal and Maya [default: m]
    #[arg(long, value_name = "UNIT")]
    pub out_unit: Option<Unit>,
    /// The cache (.abc, or .usda, which is text and several times as large)
    #[arg(long, value_name = "FILE", default_value = "out/hair.abc")]
    pub out: PathBuf,
}

/// Runs `tresses bake`.
pub fn run(args: &Args) -> Result<()> {
    let extension = formats::extension(&args.out);
    ensure!(
        matches!(&*extension, "abc" | "usda"),
        "{}: a cache is written as .abc (Alembic) or .usda (USD)",
        args.out.display()
    );
    let motion = Motion::open(&args.motion)?;
    let period = (motion.duration() * args.fps).round().clamp(1.0, MAX_FRAMES as f64);
    let frames = args.frames.unwrap_or(period as u32);
    let preset = args.settings.preset()?;
    preset.settings.check()?;
    let preparing = Preparing::new("opening the GPU");
    let gpu = pollster::block_on(Gpu::open())?;
    let pipelines = Arc::new(Pipelines::new(&gpu.device));
    let character = load::load(&preset, &gpu, &pipelines.simulate, &preparing)?;
    for note in &character.notes {
        preparing.suspend(|| eprintln!("note: {note}"));
    }
    let colliders = Companions::of(&preset.source, Shelf::default()).colliders()?;
    let (physics, quality) = (preset.settings.physics(), preset.settings.quality([16, 16], 1)?);
    let scene = Scene::new(gpu, pipelines, character, colliders, &physics, &quality, &preparing);
    let mut scene = pollster::block_on(scene)?;
    scene.apply(&preset.settings)?;
    // All of it, however far away.
    scene.set_lod(LodOptions { mode: LodMode::Off, ..Default::default() })?;
    drop(preparing);
    let (pivot, step) = (scene.pivot(), 1.0 / args.fps);
    scene.reset(&motion.gesture(0.0, pivot))?;
    let first = drawn(&scene, [&scene.hair.strands])?;
    let unit = args.out_unit.unwrap_or(Unit(1.0));
    let bar = progress::frames("baking", u64::from(frames));
    files::stream(&args.out, |file| {
        let mut cache = match &*extension {
            "usda" => {
                let options = usda::CacheOptions { unit, rate: args.fps, frames };
                Cache::Usd(usda::Cache::new(file, &first, options)?)
            }
            _ => {
                let options = abc::Options { unit, rate: args.fps, ..Default::default() };
                Cache::Alembic(abc::Cache::new(file, &first, options)?)
            }
        };
        cache.frame(&first.positions)?;
        bar.inc(1);
        for frame in 1..frames {
            scene.advance(&motion.gesture(f64::from(frame) * step, pivot), step as f32)?;
            cache.frame(&drawn(&scene, [&scene.hair.strands])?.positions)?;
            bar.inc(1);
        }
        cache.finish()
    })?;
    bar.finish_and_clear();
    let (count, vertices) = (first.len(), first.positions.len());
    say!("{}: {frames} frames of {count} strands, {vertices} vertices", args.out.display());
    Ok(())
}

/// A cache in the making.
#[allow(clippy::large_enum_variant)] // There is one.
enum Cache<W> {
    Alembic(abc::Cache<W>),
    Usd(usda::Cache<W>),
}

impl<W: Write + Seek> Cache<W> {
    fn frame(&mut self, positions: &[Vec3]) -> Result<()> {
        match self {
            Self::Alembic(cache) => cache.frame(positions)?,
            Self::Usd(cache) => cache.frame(positions)?,
        }
        Ok(())
    }

    fn finish(self) -> Result<()> {
        match self {
            Self::Alembic(cache) => drop(cache.finish()?),
            Self::Usd(cache) => drop(cache.finish()?),
        }
        Ok(())
    }
}
