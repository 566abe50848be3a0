//! `tresses demo`: the built-in character, as an image and as a loop.

use crate::{
    args::{Size, SourceArgs},
    flags::{All, CompanionFlags, RowFlags},
    photographer::Photographer,
    picture::FrameWriter,
    preset_args::PresetArgs,
    progress::TaskProgress,
    render::{FrameTimes, animate},
    say, settings_args,
};
use anyhow::{Context, Result};
use std::{path::PathBuf, time::Instant};
use tresses::groom::styles::Style;
use tresses::{LodMode, LodOptions};
use tresses_scene::{Motion, Shot, Viewpoint, camera::Angle};

/// Size of the image.
const PICTURE: Size = Size { width: 1920, height: 1200 };

/// Quality levels of the loop, from coarse to fine: size, and fraction of the strands, which are drawn wider to
/// compensate.
const LOOPS: [(Size, f32); 4] = [
    (Size { width: 400, height: 250 }, 0.12),
    (Size { width: 480, height: 300 }, 0.25),
    (Size { width: 640, height: 400 }, 0.5),
    (Size { width: 800, height: 500 }, 1.0),
];

/// Upper bound of the ratio of frame times between consecutive levels.
const FINER: f64 = 2.5;

/// Time limit for the loop, seconds.
const LOOP_SECONDS: f64 = 50.0;

/// Frame rate of the loop, frames per second.
const LOOP_FPS: f64 = 20.0;

/// Options of `tresses demo`.
#[derive(clap::Args, Debug)]
pub struct DemoArgs {
    /// Folder for demo.png and demo.webp
    #[arg(long, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Built-in hairstyle: long, bob, curly or short [default: long]
    #[arg(long, value_name = "NAME")]
    pub style: Option<String>,
    #[command(flatten)]
    pub preset: PresetArgs,
    #[command(flatten)]
    pub companion_flags: CompanionFlags,
    #[command(flatten)]
    pub rows: RowFlags<All>,
}

/// Runs `tresses demo`.
pub fn run(args: &DemoArgs) -> Result<()> {
    let mut preset = args.preset.open()?;
    SourceArgs { style: args.style.clone(), ..Default::default() }.apply(&mut preset);
    settings_args::apply(&args.companion_flags, &args.rows, &mut preset)?;
    args.preset.finish(&mut preset)?;
    let motion = Motion::named("turn").context("the built-in motions hold a turn")?;
    if let Some(style) = &preset.source.style {
        // Check the style before printing or creating anything.
        style.parse::<Style>()?;
    }

    eprintln!("Building a character with moving hair.");
    let mut scene = Photographer::open(&preset, PICTURE)?;
    eprintln!("Rendering an image on {}.", scene.adapter_name());
    let drawing = TaskProgress::new("rendering the image");
    let camera = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), PICTURE.aspect(), 1.0);
    let mut output =
        FrameWriter::create(&args.out.join("demo.png"), (PICTURE.width, PICTURE.height), 1, 1.0)?;
    let pivot = scene.character.neck();
    scene.reset(&motion.gesture(0.0, pivot))?;
    output.add(scene.frame(&camera, output.kind())?)?;
    let picture = output.finish()?;
    drop(drawing);

    let frames = (motion.duration() * LOOP_FPS).round() as u32;
    let fitting = TaskProgress::new("measuring the frame time");
    let (size, seconds) = fit(&mut scene, &motion, f64::from(frames))?;
    drop(fitting);
    let path = args.out.join("demo.webp");
    let mut output = FrameWriter::create(&path, (size.width, size.height), frames, LOOP_FPS)?;
    let times = FrameTimes { frames, fps: LOOP_FPS, lead: -motion.duration() };
    let camera = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), size.aspect(), 0.95);
    eprintln!("Rendering a loop of {frames} frames, {}x{}; about {seconds:.0} s.", size.width, size.height);
    animate(&mut scene, &Shot::still(camera), &motion, times, &mut output)?;
    say!("{picture}");
    say!("{}", output.finish()?);
    Ok(())
}

/// Sets `scene` to the finest of [`LOOPS`] that can be drawn within [`LOOP_SECONDS`], or the coarsest. Returns its size
/// and the estimated time, seconds.
fn fit(scene: &mut Photographer, motion: &Motion, frames: f64) -> Result<(Size, f64)> {
    let pivot = scene.character.neck();
    let mut fitting = (LOOPS[0].0, 0.0);
    for (i, (size, strand_fraction)) in LOOPS.into_iter().enumerate() {
        let mode = if strand_fraction < 1.0 { LodMode::Fixed(strand_fraction) } else { LodMode::Off };
        let options = LodOptions { mode, ..scene.character.hair().lod.options };
        scene.set_lod(options)?;
        scene.resize([size.width, size.height])?;
        let camera = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), size.aspect(), 0.95);
        // The level of detail depends on the camera.
        scene.watch(&camera);
        // Use the fastest frame: the first ones include compilation by the driver.
        let mut seconds = f64::INFINITY;
        for frame in 0..4 {
            let start = Instant::now();
            scene.advance(&motion.gesture(f64::from(frame) / LOOP_FPS, pivot), (1.0 / LOOP_FPS) as f32)?;
            scene.picture(&camera)?;
            seconds = seconds.min(frames * start.elapsed().as_secs_f64());
        }
        fitting = (size, seconds);
        if i + 1 == LOOPS.len() || seconds * FINER > LOOP_SECONDS {
            break;
        }
    }
    Ok(fitting)
}
