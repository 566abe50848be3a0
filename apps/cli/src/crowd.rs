//! `tresses render --crowd`: renders a crowd.

use crate::{
    photographer::Photographer,
    picture::{FrameWriter, Image, OutputFrame},
    progress,
};
use anyhow::{Result, ensure};
use tresses::{
    Budget,
    low_level::{HeadDetail, MAX_BUDGET_BIAS},
};
use tresses_scene::{Crowd, CrowdOptions, Motion, crowd::ROWS, words::grouped};

/// Most heads of a crowd.
const MAX_HEADS: u32 = 1000;

/// Frames drawn before the first, to measure costs.
const TRIALS: u32 = 4;

/// Options of a crowd.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct CrowdArgs {
    /// Draw this many heads with the same hair in rows from 2 to 40 m, each with its own pose, phase and pigment
    #[arg(long = "crowd", value_name = "HEADS", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_HEADS)), help_heading = "Image", hide_short_help = true)]
    crowd: Option<u32>,
    /// Time budget of a crowd's hair per frame, milliseconds; sets its levels of detail
    #[arg(
        long = "crowd-ms",
        value_name = "MS",
        requires = "crowd",
        help_heading = "Image",
        hide_short_help = true
    )]
    crowd_ms: Option<f32>,
    /// GPU memory budget of a crowd's hair, megabytes (10^6 bytes); sets its levels of detail
    #[arg(
        long = "crowd-mb",
        value_name = "MB",
        requires = "crowd",
        help_heading = "Image",
        hide_short_help = true
    )]
    crowd_mb: Option<f64>,
}

impl CrowdArgs {
    /// Whether a crowd is requested.
    pub fn is_given(&self) -> bool {
        self.crowd.is_some()
    }

    /// Checks the budgets.
    pub fn check(&self) -> Result<()> {
        // NaN also fails the comparison.
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

/// Draws `frames` frames of a crowd with the hair of `scene` at `fps` frames per second into `output`. Returns a
/// description of the files written and the levels of detail.
pub fn render(
    scene: &mut Photographer,
    motion: &Motion,
    (frames, fps): (u32, f64),
    args: &CrowdArgs,
    mut output: FrameWriter,
) -> Result<String> {
    let options = CrowdOptions { heads: args.crowd.unwrap_or(1), rows: ROWS, pigments: true };
    let mut crowd = Crowd::new(scene, &options)?;
    crowd.budget.budget = args.budget();
    let timed = crowd.budget.budget.milliseconds.is_finite();
    let bar = progress::frames("drawing", u64::from(frames));
    // Costs are unknown before the first frames, so draw trial frames to find the first levels.
    for trial in 0..if timed { TRIALS } else { 0 } {
        crowd.budget.reset_detail();
        let measured = scene.measured_crowd(&mut crowd, motion, (0.0, 0.0), false)?;
        // The first trial also compiles pipelines.
        if trial > 0 {
            let work = crowd.detail().work;
            crowd.budget.costs.fit(&work, measured.wall);
        }
    }
    if timed {
        crowd.budget.reset_detail();
    }
    for frame in 0..frames {
        let seconds = if frame == 0 { 0.0 } else { 1.0 / fps };
        let time = f64::from(frame) / fps;
        if timed {
            // Measure the frame, then draw it once more for the output.
            let measured = scene.measured_crowd(&mut crowd, motion, (time, seconds as f32), false)?;
            let work = crowd.detail().work;
            crowd.budget.costs.fit(&work, measured.wall);
        } else {
            let mut encoder = scene.gpu.context.device().create_command_encoder(&Default::default());
            crowd.record_advance(scene, &mut encoder, None, motion, (time, seconds as f32))?;
            scene.gpu.context.queue().submit([encoder.finish()]);
        }
        if !output.keeps_only_last() || frame + 1 == frames {
            output.add(OutputFrame::Shown(picture(scene, &crowd)?))?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let description = describe(&crowd, scene);
    Ok(format!("{}\n{description}", output.finish()?))
}

/// Renders the last frame. Blocks.
fn picture(scene: &mut Photographer, crowd: &Crowd) -> Result<Image> {
    loop {
        let mut encoder = scene.gpu.context.device().create_command_encoder(&Default::default());
        crowd.record_draw(scene, &mut encoder, None)?;
        scene.gpu.context.queue().submit([encoder.finish()]);
        if pollster::block_on(scene.is_complete())? {
            break;
        }
    }
    let rgba = pollster::block_on(scene.targets().read())?;
    let [width, height] = scene.targets().size;
    Ok(Image { width, height, rgba })
}

/// Describes the levels of detail of the last frame, and its costs.
pub fn describe(crowd: &Crowd, scene: &Photographer) -> String {
    let detail = crowd.detail();
    let visible = crowd.hair().filter(|hair| hair.is_visible()).count();
    let asleep = crowd.hair().filter(|hair| hair.is_asleep()).count();
    let sum = |of: &dyn Fn(&HeadDetail) -> u64| grouped(detail.heads.iter().map(of).sum());
    let [shared, own, view] = crowd.bytes(scene).map(|bytes| bytes as f64 * 1e-6);
    let budget = crowd.budget.budget;
    let kept = if detail.fits {
        ""
    } else if detail.bias < MAX_BUDGET_BIAS {
        ", approaching the levels for the budget by 1/8 octave per frame"
    } else {
        ", the coarsest levels, which exceed the budget"
    };
    let mut of = String::new();
    if budget.milliseconds.is_finite() {
        of +=
            &format!("\nTime: {:.1} ms expected, budget {:.1} ms", detail.milliseconds, budget.milliseconds);
    }
    if budget.bytes < u64::MAX {
        let [held, all] = [crowd.held(scene), budget.bytes].map(|bytes| bytes as f64 * 1e-6);
        of += &format!("\nMemory of hair and its lighting: {held:.1} MB, budget {all:.1} MB");
    }
    format!(
        "{} heads, {visible} in view, {asleep} asleep: {} strands, {} vertices, {} guides; bias {:.2}{kept}\n\
         GPU memory: {shared:.1} MB shared, {own:.1} MB of heads, {view:.1} MB of the view{of}",
        crowd.len(),
        sum(&|head| head.strand_count.into()),
        sum(&|head| u64::from(head.strand_count) * u64::from(head.vertex_count)),
        sum(&|head| head.guide_count.into()),
        detail.bias,
    )
}
