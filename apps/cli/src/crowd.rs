//! Pictures of a crowd: `tresses render --crowd`.

use crate::{
    photographer::Photographer,
    picture::{Frame, Kind, Output, Picture},
    progress, render,
};
use anyhow::{Result, ensure};
use tresses::{
    groom::mannequin::facial::Beard,
    lod::{Budget, budget::COARSEST},
};
use tresses_scene::{Crowd, CrowdOptions, Motion, Settings, crowd::ROWS, words::grouped};

/// The most heads of a crowd.
const MOST: u32 = 1000;

/// Pictures that are drawn before the first one for what they cost.
const TRIALS: u32 = 4;

/// The options of a crowd.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct CrowdArgs {
    /// Heads with the same hair in rows from 2 to 40 m, each with its own pose, phase and pigment, instead of one
    #[arg(long = "crowd", value_name = "HEADS", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST)), help_heading = "Picture", hide_short_help = true)]
    crowd: Option<u32>,
    /// Milliseconds that the hair of a crowd may take in a frame: its levels of detail are chosen so
    #[arg(
        long = "crowd-ms",
        value_name = "MS",
        requires = "crowd",
        help_heading = "Picture",
        hide_short_help = true
    )]
    crowd_ms: Option<f32>,
    /// Megabytes (10^6) of GPU memory that the hair of a crowd may take, likewise
    #[arg(
        long = "crowd-mb",
        value_name = "MB",
        requires = "crowd",
        help_heading = "Picture",
        hide_short_help = true
    )]
    crowd_mb: Option<f64>,
}

impl CrowdArgs {
    /// Whether there is to be a crowd.
    pub fn is_given(&self) -> bool {
        self.crowd.is_some()
    }

    /// Refuses what a crowd has not.
    pub fn check(&self, args: &render::Args, settings: &Settings) -> Result<()> {
        if !self.is_given() {
            return Ok(());
        }
        let one = args.distance.is_some() || args.distance_to.is_some() || args.zoom != 1.0;
        ensure!(
            !one,
            "a crowd is seen from where all of it is in the picture: leave out --zoom and --distance"
        );
        ensure!(!Kind::of(&args.out)?.has_layers(), "a crowd is drawn without layers: .png instead of .exr");
        ensure!(!args.transparent, "--transparent is for one head: leave out --crowd");
        ensure!(args.debug.debug.is_none(), "--debug looks into one head: leave out --crowd");
        ensure!(
            args.animation.is_none() && args.morphs.is_empty(),
            "the heads of a crowd are rigid: leave out --animation and --morph"
        );
        let shaved = settings.style.face.beard == Beard::None;
        ensure!(shaved, "nothing grows on the faces of a crowd: leave out --beard");
        // Also false for what is no number.
        let is_some = |value: f64| value > 0.0 && value.is_finite();
        ensure!(self.crowd_ms.is_none_or(|ms| is_some(ms.into())), "--crowd-ms must be a number above 0");
        ensure!(self.crowd_mb.is_none_or(is_some), "--crowd-mb must be a number above 0");
        Ok(())
    }

    fn budget(&self) -> Budget {
        let none = Budget::default();
        Budget {
            milliseconds: self.crowd_ms.unwrap_or(none.milliseconds),
            bytes: self.crowd_mb.map_or(none.bytes, |mb| (mb * 1e6) as u64),
        }
    }
}

/// Draws a crowd of the hair of `scene`, and says what was written and at which levels.
pub fn render(scene: &mut Photographer, motion: &Motion, frames: u32, args: &render::Args) -> Result<String> {
    let options = CrowdOptions { heads: args.crowd.crowd.unwrap_or(1), rows: ROWS, pigments: true };
    let mut crowd = Crowd::new(scene, &options)?;
    crowd.budget = args.crowd.budget();
    let timed = crowd.budget.milliseconds.is_finite();
    let mut output = Output::create(&args.out, (args.size.width, args.size.height), frames, args.fps)?;
    let bar = progress::frames("drawing", u64::from(frames));
    // What work costs here is not known before some is done: the first levels are found by trying.
    for trial in 0..if timed { TRIALS } else { 0 } {
        crowd.choose_anew();
        let measured = scene.measured_crowd(&mut crowd, motion, (0.0, 0.0), false)?;
        // The first compiles.
        if trial > 0 {
            let work = crowd.chosen().work;
            crowd.costs.fit(&work, measured.wall);
        }
    }
    if timed {
        crowd.choose_anew();
    }
    for frame in 0..frames {
        let seconds = if frame == 0 { 0.0 } else { 1.0 / args.fps };
        let time = f64::from(frame) / args.fps;
        if timed {
            // Costs are known by frames: the picture itself is drawn once more.
            let measured = scene.measured_crowd(&mut crowd, motion, (time, seconds as f32), false)?;
            let work = crowd.chosen().work;
            crowd.costs.fit(&work, measured.wall);
        } else {
            let mut encoder = scene.gpu.device.create_command_encoder(&Default::default());
            crowd.record_advance(scene, &mut encoder, None, motion, (time, seconds as f32))?;
            scene.gpu.queue.submit([encoder.finish()]);
        }
        if !output.keeps_only_last() || frame + 1 == frames {
            output.add(Frame::Shown(picture(scene, &crowd)?))?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let said = said(&crowd, scene);
    Ok(format!("{}\n{said}", output.finish()?))
}

/// The picture of the last frame. Blocks.
fn picture(scene: &mut Photographer, crowd: &Crowd) -> Result<Picture> {
    loop {
        let mut encoder = scene.gpu.device.create_command_encoder(&Default::default());
        crowd.record_draw(scene, &mut encoder, None)?;
        scene.gpu.queue.submit([encoder.finish()]);
        if pollster::block_on(scene.is_complete())? {
            break;
        }
    }
    let rgba = pollster::block_on(scene.targets().read(&scene.gpu.device, &scene.gpu.queue))?;
    let [width, height] = scene.targets().size;
    Ok(Picture { width, height, rgba })
}

/// What was chosen for the last frame, and what it takes.
pub fn said(crowd: &Crowd, scene: &Photographer) -> String {
    let chosen = crowd.chosen();
    let seen = chosen.heads.iter().filter(|head| head.seen).count();
    let asleep = chosen.heads.iter().filter(|head| head.asleep).count();
    let sum = |of: &dyn Fn(&tresses::lod::HeadChosen) -> u64| grouped(chosen.heads.iter().map(of).sum());
    let [shared, own, view] = crowd.bytes(scene).map(|bytes| bytes as f64 * 1e-6);
    let budget = crowd.budget;
    let kept = if chosen.fits {
        ""
    } else if chosen.bias < COARSEST {
        ", on the way to the levels that the budget asks for, by an eighth of an octave in each frame"
    } else {
        ", the coarsest levels, which are beyond the budget"
    };
    let mut of = String::new();
    if budget.milliseconds.is_finite() {
        of += &format!("\nTime: {:.1} ms expected of {:.1}", chosen.milliseconds, budget.milliseconds);
    }
    if budget.bytes < u64::MAX {
        let [held, all] = [crowd.held(scene), budget.bytes].map(|bytes| bytes as f64 * 1e-6);
        of += &format!("\nMemory of hair and its light: {held:.1} MB of {all:.1}");
    }
    format!(
        "{} heads, {seen} in view, {asleep} asleep: {} strands, {} vertices, {} guides; bias {:.2}{kept}\n\
         GPU memory: {shared:.1} MB shared, {own:.1} MB of heads, {view:.1} MB of the view{of}",
        crowd.len(),
        sum(&|head| head.strands.into()),
        sum(&|head| u64::from(head.strands) * u64::from(head.vertices)),
        sum(&|head| head.guides.into()),
        chosen.bias,
    )
}
