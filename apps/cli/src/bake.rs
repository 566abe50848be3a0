//! `tresses bake`: writes simulated hair as an Alembic or USD cache.

use crate::{
    export::drawn_strands, files, progress, progress::TaskProgress, say, settings_args::SettingsArgs,
};
use anyhow::Result;
use std::path::PathBuf;
use tresses::{
    Gpu, LodMode, LodOptions,
    groom::{
        export::{CacheOptions, Writer},
        formats::{self, ContentKind},
        orient::LengthUnit,
    },
};
use tresses_scene::{CompanionFiles, Motion, Scene, Shelf};

/// Longest cache, frames.
const MAX_FRAMES: i64 = 100_000;

/// Options of `tresses bake`.
#[derive(clap::Args, Debug)]
pub struct BakeArgs {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// Motion of the character: still, nod, turn, shake, walk, dance, or a keyframe file (.json)
    #[arg(long, value_name = "NAME", default_value = "still")]
    pub motion: String,
    /// Frames to simulate and write [default: one period of the motion]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_FRAMES))]
    pub frames: Option<u32>,
    /// Frames per second
    #[arg(long, value_name = "F", default_value = "24", value_parser = crate::args::fps)]
    pub fps: f64,
    /// Unit of the file: cm for Unreal and Maya [default: m]
    #[arg(long, value_name = "UNIT")]
    pub out_unit: Option<LengthUnit>,
    /// Cache file
    #[arg(long, value_name = "FILE", default_value = "out/hair.abc", help = out_help())]
    pub out: PathBuf,
}

/// Runs `tresses bake`.
pub fn run(args: &BakeArgs) -> Result<()> {
    let writer = Writer::holding(&args.out, ContentKind::Frames)?;
    let motion = Motion::open(&args.motion)?;
    let period_frames = (motion.duration() * args.fps).round().clamp(1.0, MAX_FRAMES as f64);
    let frames = args.frames.unwrap_or(period_frames as u32);
    let preset = args.settings.preset()?;
    preset.settings.check()?;
    let preparing = TaskProgress::new("opening the GPU");
    let gpu = pollster::block_on(Gpu::open())?;
    let character = pollster::block_on(preset.character(&gpu.context, &preparing))?;
    for note in &character.notes {
        preparing.suspend(|| eprintln!("note: {note}"));
    }
    let colliders = CompanionFiles::of(&preset.source, Shelf::default()).colliders()?;
    let quality = preset.settings.quality([16, 16], 1)?;
    let scene = Scene::new(gpu, character, colliders, &preset.settings, &quality, &preparing);
    let mut scene = pollster::block_on(scene)?;
    scene.apply(&preset.settings)?;
    // Write all strands, whatever their level of detail.
    scene.set_lod(LodOptions { mode: LodMode::Off, ..Default::default() })?;
    drop(preparing);
    let (pivot, frame_interval) = (scene.character.neck(), 1.0 / args.fps);
    scene.reset(&motion.gesture(0.0, pivot))?;
    let first_frame = drawn_strands(&scene, [&scene.character.hair().strands])?;
    let unit = args.out_unit.unwrap_or(LengthUnit(1.0));
    let bar = progress::frames("baking", u64::from(frames));
    files::stream(&args.out, |file| {
        let mut cache =
            writer.cache(Box::new(file), &first_frame, CacheOptions { unit, rate: args.fps, frames })?;
        cache.frame(&first_frame.positions)?;
        bar.inc(1);
        for frame in 1..frames {
            let gesture = motion.gesture(f64::from(frame) * frame_interval, pivot);
            scene.advance(&gesture, frame_interval as f32)?;
            cache.frame(&drawn_strands(&scene, [&scene.character.hair().strands])?.positions)?;
            bar.inc(1);
        }
        Ok(cache.finish()?)
    })?;
    bar.finish_and_clear();
    let (count, vertices) = (first_frame.len(), first_frame.positions.len());
    say!("{}: {frames} frames of {count} strands, {vertices} vertices", args.out.display());
    Ok(())
}

fn out_help() -> String {
    let all = formats::listed(&formats::written(ContentKind::Frames), "or");
    format!("Cache file ({all}); .usda is text and several times as large as .abc")
}
