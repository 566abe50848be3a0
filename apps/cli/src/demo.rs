//! `tresses demo`: the built-in character, as a picture and as a loop.

use crate::{
    args::{Size, SourceArgs},
    flags::{All, CompanionFlags, RowFlags},
    interrupt,
    picture::Output,
    preset_args::PresetArgs,
    progress,
    render::{Times, animate},
    say,
    scene::Scene,
    settings_args,
};
use anyhow::{Context, Result};
use std::{path::PathBuf, time::Instant};
use tresses_scene::{Camera, Motion, Shot, camera::View};

/// The size of the picture.
const PICTURE: Size = Size { width: 1920, height: 1200 };

/// The size and speed of the loop: small enough that a software driver draws it in some minutes.
const LOOP: Size = Size { width: 800, height: 500 };
const LOOP_FPS: f64 = 20.0;

/// The options of `tresses demo`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The folder that receives demo.png and demo.webp
    #[arg(long, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// A built-in hairstyle: long, bob, curly or short [default: long]
    #[arg(long, value_name = "NAME")]
    pub style: Option<String>,
    #[command(flatten)]
    pub preset: PresetArgs,
    #[command(flatten)]
    pub companions: CompanionFlags,
    #[command(flatten)]
    pub rows: RowFlags<All>,
}

/// Runs `tresses demo`.
pub fn run(args: &Args) -> Result<()> {
    let mut preset = args.preset.open()?;
    SourceArgs { style: args.style.clone(), ..Default::default() }.apply(&mut preset);
    settings_args::apply(&args.companions, &args.rows, &mut preset)?;
    args.preset.finish(&mut preset)?;
    let motion = Motion::named("turn").context("the built-in motions hold a turn")?;

    let spinner = progress::spinner("growing and draping the hair, drawing a picture");
    let mut scene = Scene::open(&preset, PICTURE)?;
    eprintln!("Drawing on {}.", scene.adapter_name());
    let camera = Camera::portrait(View::ThreeQuarter, scene.subject(), PICTURE.aspect(), 1.0);
    let mut output = Output::create(&args.out.join("demo.png"), (PICTURE.width, PICTURE.height), 1, 1.0)?;
    let pivot = scene.pivot();
    scene.reset(&motion.pose(0.0, pivot))?;
    output.add(scene.picture(&camera)?)?;
    let picture = output.finish()?;
    spinner.finish_and_clear();
    interrupt::check()?;

    let frames = (motion.duration() * LOOP_FPS).round() as u32;
    scene.resize([LOOP.width, LOOP.height])?;
    let path = args.out.join("demo.webp");
    let mut output = Output::create(&path, (LOOP.width, LOOP.height), frames, LOOP_FPS)?;
    let times = Times { frames, fps: LOOP_FPS, lead: -motion.duration() };
    let camera = Camera::portrait(View::ThreeQuarter, scene.subject(), LOOP.aspect(), 0.95);
    // How long it takes is told by a frame of it: most of its work does not depend on the size. A second one,
    // since the first still makes pipelines.
    let mut seconds_at = |time| -> Result<f64> {
        let start = Instant::now();
        scene.advance(&motion.pose(time, pivot), (1.0 / LOOP_FPS) as f32)?;
        scene.picture(&camera)?;
        Ok(start.elapsed().as_secs_f64())
    };
    seconds_at(0.0)?;
    let seconds = f64::from(frames) * seconds_at(1.0 / LOOP_FPS)?;
    eprintln!("Drawing a loop of {frames} frames; about {seconds:.0} s.");
    animate(&mut scene, &Shot::still(camera), &motion, times, &mut output)?;
    say!("{picture}");
    say!("{}", output.finish()?);
    Ok(())
}
