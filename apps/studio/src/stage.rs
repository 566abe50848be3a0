//! The character in the window: the only file that talks to the renderer, a frame into a texture at a time.

use crate::{
    ball,
    blit::{Blit, Seen},
    flight::{Flight, Watcher},
    pace::Level,
};
use anyhow::Result;
use eframe::{egui, egui_wgpu::RenderState};
use std::time::Duration;
use tresses::{
    character::Gesture,
    glam::Vec3,
    gpu::{Timings, readback::Pending, timings::Rows},
};
use tresses_scene::{Facts, Scene, Viewpoint};
use web_time::Instant;

/// What a frame is made for.
#[derive(Clone, Debug)]
pub struct Moment {
    /// What the character does.
    pub gesture: Gesture,
    /// Seconds of hair since the frame before.
    pub seconds: f32,
    /// Who looks.
    pub camera: Viewpoint,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Pixels that are drawn per pixel of it, along each axis.
    pub ssaa: u32,
    /// The middle of the ball, metres.
    pub ball: Option<Vec3>,
    /// Whether nothing but `ssaa` is other than in the frame before.
    pub again: bool,
    /// How finely it is drawn.
    pub level: Level,
    /// Whether it takes so long that others go between its parts.
    pub parts: bool,
}

/// The picture that is seen, which is not always the one that is drawn.
pub struct Picture {
    /// To be painted.
    pub seen: Seen,
    /// What it is drawn into.
    view: wgpu::TextureView,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Pixels that were drawn per pixel of it, along each axis.
    pub ssaa: u32,
    /// How finely it was drawn.
    pub level: Level,
    /// Strands in it.
    pub strands: u32,
    /// Which of all frames it is, from 1.
    pub number: u64,
}

/// A character, its picture, and at most one frame under way.
pub struct Show {
    /// The character.
    pub stage: Scene,
    picture: Option<Picture>,
    flight: Option<(Flight, Level)>,
    blit: Blit,
    /// Frames drawn.
    pub frames: u64,
    /// Milliseconds that the last frame took, from recording to its end.
    pub milliseconds: f32,
    /// Of the stages, where the adapter's timestamps mean something.
    timings: Option<Timings>,
    /// Times on their way.
    rows: Option<Rows>,
    /// Milliseconds of the stages of a frame not long ago.
    stages: Vec<(&'static str, f64)>,
    watcher: Watcher,
}

impl Show {
    /// Shows `stage` in the window of `state`.
    pub fn new(stage: Scene, state: &RenderState) -> Self {
        let context = &stage.gpu.context;
        let watcher = Watcher::new(context.device());
        let timed = context.tier().timestamps && !context.tier().software;
        let timings = timed.then(|| Timings::new(context));
        let (rows, stages) = (None, Vec::new());
        Self {
            stage,
            picture: None,
            flight: None,
            blit: Blit::new(state),
            frames: 0,
            milliseconds: 0.0,
            timings,
            rows,
            stages,
            watcher,
        }
    }

    /// Whether the times of stages can be known.
    pub fn times_stages(&self) -> bool {
        self.timings.is_some()
    }

    /// Milliseconds of the stages of a frame not long ago.
    pub fn stages(&self) -> &[(&'static str, f64)] {
        &self.stages
    }

    /// Another character in its place, whose picture is still to come.
    pub fn replace(&mut self, stage: Scene) {
        self.give_up();
        self.stage = stage;
    }

    /// A frame that was under way and has landed gives its milliseconds, and is the picture from here on.
    pub fn landed(&mut self) -> Option<f32> {
        let (flight, level) = self.flight.as_ref()?;
        let ms = flight.landed()?;
        let targets = self.stage.targets();
        let view = targets.picture();
        let seen = match self.picture.take().filter(|picture| picture.view == *view) {
            Some(same) => same.seen,
            None => self.blit.of(self.stage.gpu.context.device(), view),
        };
        self.picture = Some(Picture {
            seen,
            view: view.clone(),
            size: targets.size,
            ssaa: targets.ssaa,
            level: *level,
            strands: self.stage.detail().strands,
            number: self.frames,
        });
        self.flight = None;
        self.milliseconds = ms;
        Some(ms)
    }

    /// The frame that is under way, if any, is not finished: the next may begin.
    pub fn give_up(&mut self) {
        if let Some((flight, _)) = self.flight.take() {
            flight.give_up();
        }
    }

    /// Whether a frame is under way, as far as one has looked.
    pub fn is_under_way(&self) -> bool {
        self.flight.is_some()
    }

    /// How many parts of the frame that is under way are done, of how many.
    pub fn progress(&self) -> Option<(usize, usize)> {
        self.flight.as_ref().map(|(flight, _)| flight.progress())
    }

    /// Sizes of what is drawn.
    pub fn facts(&self) -> Facts {
        self.stage.facts()
    }

    /// The last frame that is done.
    pub fn picture(&self) -> Option<&Picture> {
        self.picture.as_ref()
    }

    /// Draws a frame; the one before must have [landed](Self::landed).
    pub fn draw(&mut self, state: &RenderState, context: &egui::Context, moment: &Moment) -> Result<()> {
        let begun = Instant::now();
        let targets = self.stage.targets();
        if (targets.size, targets.ssaa) != (moment.size, moment.ssaa) {
            self.stage.resample(moment.size, moment.ssaa)?;
        }
        let mut encoder = state.device.create_command_encoder(&Default::default());
        self.stage.watch(&moment.camera);
        self.stage.set_ball(moment.ball, ball::RADIUS)?;
        if let Some(done) = self.rows.as_mut().and_then(Rows::take) {
            (self.stages, self.rows) = (done?, None);
        }
        // One frame's times at a time.
        let mut parts = moment.parts.then(Timings::of_parts);
        let timed = self.timings.as_mut().filter(|_| self.rows.is_none() && parts.is_none());
        let is_timed = timed.is_some();
        let mut timings = timed.or(parts.as_mut());
        if moment.again {
            self.stage.record_redraw(&mut encoder, timings.as_deref_mut())?;
        } else {
            self.stage.record_advance(
                &mut encoder,
                timings.as_deref_mut(),
                &moment.gesture,
                moment.seconds,
            )?;
            self.stage.place_colliders();
            self.stage.record_draw(&mut encoder, timings.as_deref_mut(), &moment.camera)?;
        }
        if let Some(timings) = &timings {
            timings.resolve(&mut encoder);
        }
        let mut recorded = timings.map(Timings::parts).unwrap_or_default();
        recorded.push(encoder.finish());
        self.frames += 1;
        let context = context.clone();
        // Without a wait the window would be painted twice.
        let wake = move || context.request_repaint_after(Duration::from_nanos(1));
        let flight = Flight::start(&state.queue, begun, recorded, wake);
        if is_timed && let Some(timings) = &mut self.timings {
            self.rows = Some(timings.later(&self.stage.gpu.context));
        }
        self.watcher.watch(&flight);
        self.flight = Some((flight, moment.level));
        Ok(())
    }

    /// The picture of the last frame, which has landed, on its way to the CPU.
    pub fn copy(&self) -> tresses::Result<Pending> {
        Pending::texture(&self.stage.gpu.context, self.stage.targets().picture().texture())
    }
}
