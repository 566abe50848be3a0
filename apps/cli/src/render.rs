//! `tresses render`: an image, numbered frames, an animation or a video of a groom or a built-in style.

use crate::{
    args::{self, Size},
    crowd, debug,
    photographer::Photographer,
    picture::{Film, FrameWriter, OutputKind},
    progress, say,
    settings_args::SettingsArgs,
};
use anyhow::{Result, bail, ensure};
use std::path::PathBuf;
use tresses::{
    Background, HairHair, HairHairMode, groom::cards::CardOptions, low_level::DebugView, renderer::Renderer,
};
use tresses_scene::{Motion, Preset, Shot, Viewpoint, camera::Angle, motion::NAMES};

/// Longest animation, frames.
const MAX_FRAMES: u32 = 100_000;

/// Options of `tresses render`.
#[derive(clap::Args, Debug)]
#[command(after_help = "These are the most common options; --help lists all of them by topic.")]
#[command(after_long_help = "Set any other parameter with --set NAME=VALUE; `tresses knobs` lists them.")]
pub struct RenderArgs {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// Motion of the character: still, nod, turn, shake, walk, dance, or a keyframe file (.json)
    #[arg(long, value_name = "NAME", default_value = "still", help_heading = "Image")]
    pub motion: String,
    /// Animation of the head mesh, by its name in the file (glTF, USD)
    #[arg(long, value_name = "NAME", help_heading = "Image")]
    pub animation: Option<String>,
    /// Weight of a morph target, instead of the animation's; may be repeated
    #[arg(long = "morph", value_name = "NAME=WEIGHT", value_parser = args::morph, help_heading = "Image", hide_short_help = true)]
    pub morphs: Vec<(String, f32)>,
    /// Frames to simulate; a single .png or .exr shows the last [default: 1 for these, else one period of the motion]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_FRAMES)), help_heading = "Image")]
    pub frames: Option<u32>,
    /// Frames per second
    #[arg(long, value_name = "F", default_value = "24", value_parser = args::fps, help_heading = "Image")]
    pub fps: f64,
    /// Width and height in pixels: each 16 to 16384, together at most 33,177,600 (7680x4320)
    #[arg(long, value_name = "WxH", default_value = "1280x720", help_heading = "Image")]
    pub size: Size,
    /// Position of the camera
    #[arg(long, value_name = "NAME", value_enum, default_value_t, help_heading = "Image")]
    pub camera: Angle,
    /// Move the camera with the head
    #[arg(long, help_heading = "Image", hide_short_help = true)]
    pub follow: bool,
    /// Distance of the camera: close, normal, far, or a magnification
    #[arg(long, value_name = "FACTOR", default_value = "normal", value_parser = args::zoom, help_heading = "Image")]
    pub zoom: f32,
    /// Distance of the camera from the center of its subject, meters; instead of --zoom
    #[arg(long, value_name = "METERS", value_parser = args::distance, conflicts_with = "zoom", help_heading = "Image", hide_short_help = true)]
    pub distance: Option<f32>,
    /// Distance in the last frame; the camera moves by equal factors in equal times
    #[arg(long, value_name = "METERS", value_parser = args::distance, help_heading = "Image", hide_short_help = true)]
    pub distance_to: Option<f32>,
    /// Draw the hair as this number of cards instead of strands; they are baked first
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(CardOptions::MAX_CARDS)), help_heading = "Image", hide_short_help = true)]
    pub cards: Option<u32>,
    #[command(flatten)]
    pub crowd: crowd::CrowdArgs,
    /// Output: one .png or .exr (linear, with depth, coverage, motion and strands of the hair), numbered frames (a
    /// folder, or a name with #### in it), an animation (.webp, .gif, .apng), or a video (.mp4, .webm; needs ffmpeg)
    #[arg(long, value_name = "PATH", default_value = "out/render.png", help_heading = "Image")]
    pub out: PathBuf,
    /// Leave the background transparent; .png and .exr have an alpha channel
    #[arg(long, help_heading = "Image", hide_short_help = true)]
    pub transparent: bool,
    #[command(flatten)]
    pub debug: debug::DebugArgs,
}

impl RenderArgs {
    /// Returns the preset with all options applied, as the debug view needs it.
    pub fn preset(&self) -> Result<Preset> {
        let mut preset = self.settings.preset()?;
        let hair_hair = &mut preset.settings.simulation.hair_hair;
        if self.debug.debug == Some(DebugView::Density) && hair_hair.mode == HairHairMode::Off {
            // The density view needs the grid, so keep it without any effect on the hair.
            *hair_hair = HairHair { speed: 0.0, friction: 0.0, ..HairHair::default() };
        }
        self.debug.check(&preset.settings.physics())?;
        Ok(preset)
    }
}

/// Runs `tresses render`.
pub fn run(args: &RenderArgs) -> Result<()> {
    let kind = OutputKind::of(&args.out)?;
    let motion = Motion::open(&args.motion)?;
    let frames = |period: f64| -> Result<u32> {
        match args.frames {
            Some(frames) => Ok(frames),
            None if kind.is_still() => Ok(1),
            None => {
                let frames = (period * args.fps).round().max(1.0);
                ensure!(
                    frames <= f64::from(MAX_FRAMES),
                    "the motion has {frames} frames, but at most {MAX_FRAMES} are drawn; give --frames"
                );
                Ok(frames as u32)
            }
        }
    };
    let known = frames(motion.duration())?;
    // Check the options before opening or creating anything.
    let mut preset = args.preset()?;
    ensure!(
        args.cards.is_none() || args.debug.debug.is_none(),
        "--debug shows strands: remove --cards, or --debug"
    );
    if args.crowd.is_given() {
        check_crowd(args)?;
    }
    ensure!(
        !args.transparent || kind.has_alpha(),
        "{}: --transparent needs .png or .exr",
        args.out.display()
    );
    if kind == OutputKind::Film {
        Film::check(&args.out)?;
    }
    if kind.has_layers() {
        let renderer = preset.settings.renderer(16)?;
        ensure!(args.debug.debug.is_none(), "--debug does not support .exr: choose .png");
        ensure!(args.cards.is_none(), "--cards does not support .exr: choose .png");
        ensure!(
            matches!(renderer, Renderer::Tiles(_)) && preset.settings.ssaa == 1,
            ".exr layers need tiles without supersampling: remove --renderer and --ssaa"
        );
    }
    if args.crowd.is_given() {
        preset.settings.lod = tresses_scene::crowd::levels(preset.settings.lod);
    }
    let moves = known > 1 || args.animation.is_some() || args.crowd.is_given();
    let mut scene = Photographer::open_as(&preset, args.size, moves, args.cards)?;
    let period = bend(&mut scene, &motion, args)?.unwrap_or(motion.duration());
    let frames = frames(period)?;
    if args.crowd.is_given() {
        let output = FrameWriter::create(&args.out, (args.size.width, args.size.height), frames, args.fps)?;
        let written = crowd::render(&mut scene, &motion, (frames, args.fps), &args.crowd, output)?;
        say!("{written}");
        return Ok(());
    }
    scene.show(&args.debug)?;
    if args.transparent {
        scene.picture.background = Background::transparent();
    }
    let camera = Viewpoint::portrait(args.camera, scene.subject(), args.size.aspect(), args.zoom);
    let camera = args.distance.map_or(camera, |distance| camera.at_distance(distance));
    let shot = args.distance_to.map_or(Shot::still(camera), |distance| Shot::moving(camera, distance));
    let written = record(&mut scene, &shot, &motion, (frames, period), args)?;
    say!("{written}");
    Ok(())
}

/// Checks that the options are valid for a crowd.
fn check_crowd(args: &RenderArgs) -> Result<()> {
    let one = args.distance.is_some() || args.distance_to.is_some() || args.zoom != 1.0;
    ensure!(!one, "the camera of a crowd frames all heads: remove --zoom, --distance and --distance-to");
    ensure!(!OutputKind::of(&args.out)?.has_layers(), "--crowd does not support .exr: choose .png");
    ensure!(!args.transparent, "--transparent does not support --crowd: remove one of them");
    ensure!(args.debug.debug.is_none(), "--debug does not support --crowd: remove one of them");
    args.crowd.check()
}

/// Sets animation and morph targets of the body from `args`. Returns the animation's duration in seconds, if there is
/// one.
fn bend(scene: &mut Photographer, motion: &Motion, args: &RenderArgs) -> Result<Option<f64>> {
    // Built-in motions use morph targets of the built-in character, which other characters may lack.
    let keyed = motion.shapes().filter(|_| !NAMES.contains(&args.motion.as_str()));
    let Some(rig) = scene.character.rig_mut() else {
        let needs_rig = args.animation.is_some() || !args.morphs.is_empty() || keyed.count() > 0;
        ensure!(
            !needs_rig,
            "the head has no animations and no blend shapes: give a head that has them with --head (glTF, USD)"
        );
        return Ok(None);
    };
    if let Some(name) = &args.animation
        && rig.animations().next().is_none()
    {
        bail!(
            "the body has no animation {name:?}: it has no animations; --motion has {}",
            NAMES[1..].join(", ")
        );
    }
    rig.set_animation(args.animation.as_deref())?;
    keyed.map(|name| rig.find_shape(name)).collect::<tresses::Result<Vec<_>>>()?;
    for (name, weight) in &args.morphs {
        rig.set_shape(name, *weight)?;
    }
    Ok(rig.duration().map(f64::from).filter(|seconds| *seconds > 0.0))
}

fn record(
    scene: &mut Photographer,
    shot: &Shot,
    motion: &Motion,
    (frames, period): (u32, f64),
    args: &RenderArgs,
) -> Result<String> {
    let size = (args.size.width, args.size.height);
    let mut output = FrameWriter::create(&args.out, size, frames, args.fps)?.with_alpha(args.transparent);
    // A whole period of a repeating motion loops, so the hair starts with a warm-up period.
    let is_loop = output.kind().is_animation()
        && (motion.repeats() || args.animation.is_some())
        && (f64::from(frames) / args.fps - period).abs() < 0.5 / args.fps;
    let lead = if is_loop { -period } else { 0.0 };
    let shot = if args.follow { shot.following(scene.subject()) } else { *shot };
    animate(scene, &shot, motion, FrameTimes { frames, fps: args.fps, lead }, &mut output)?;
    output.finish()
}

/// Timing of a sequence of frames.
#[derive(Clone, Copy, Debug)]
pub struct FrameTimes {
    /// Number of frames.
    pub frames: u32,
    /// Frames per second.
    pub fps: f64,
    /// Start of the simulation relative to the first frame, seconds; negative or zero.
    pub lead: f64,
}

/// Animates the character and adds every frame to `output`.
pub fn animate(
    scene: &mut Photographer,
    shot: &Shot,
    motion: &Motion,
    times: FrameTimes,
    output: &mut FrameWriter,
) -> Result<()> {
    if times.frames > 1 && !output.keeps_only_last() && scene.seeks_range() {
        // One color range for all frames: simulate them once without drawing to measure it.
        play(scene, shot, motion, times, "measuring", |scene, _, _| scene.observe())?;
        scene.settle_range()?;
    }
    play(scene, shot, motion, times, "drawing", |scene, frame, camera| {
        if !output.keeps_only_last() || frame + 1 == times.frames {
            output.add(scene.frame(camera, output.kind())?)?;
        }
        Ok(())
    })
}

/// Plays the motion from its start and calls `each` for every frame.
pub fn play(
    scene: &mut Photographer,
    shot: &Shot,
    motion: &Motion,
    times: FrameTimes,
    work: &'static str,
    mut each: impl FnMut(&mut Photographer, u32, &Viewpoint) -> Result<()>,
) -> Result<()> {
    let pivot = scene.character.neck();
    let step = 1.0 / times.fps;
    let mut time = times.lead;
    let last = times.frames.max(2) - 1;
    let at = |frame: u32| shot.at(if times.frames == 1 { 1.0 } else { frame as f32 / last as f32 });
    scene.watch(&at(0));
    scene.reset(&motion.gesture(time, pivot))?;
    let lead_frames = (-times.lead * times.fps).round().max(0.0) as u64;
    let bar = progress::frames(work, lead_frames + u64::from(times.frames));
    for _ in 0..lead_frames {
        time += step;
        scene.advance(&motion.gesture(time, pivot), step as f32)?;
        bar.inc(1);
    }
    for frame in 0..times.frames {
        let camera = at(frame);
        if frame > 0 {
            // The camera follows the head's last position, and the level of detail depends on the camera.
            let head = scene.character.head();
            scene.watch(&shot.with(&camera, &head));
            scene.advance(&motion.gesture(f64::from(frame) * step, pivot), step as f32)?;
        }
        let head = scene.character.head();
        each(scene, frame, &shot.with(&camera, &head))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}
