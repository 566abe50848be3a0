//! The character in the window. Only this file talks to the renderer; it draws each frame into a texture.

use crate::{
    ball,
    blit::{Blit, DisplayImage},
    flight::{Flight, Watcher},
    pace::QualityLevel,
};
use anyhow::Result;
use eframe::{egui, egui_wgpu::RenderState};
use std::time::Duration;
use tresses::{
    Gesture, Pose, Timings,
    glam::Vec3,
    low_level::{Pending, PendingTimings},
};
use tresses_scene::{Facts, Scene, Viewpoint};
use web_time::Instant;

/// Description of one frame.
#[derive(Clone, Debug)]
pub struct FrameContext {
    /// The character's gesture.
    pub gesture: Gesture,
    /// Time step of the hair, seconds.
    pub seconds: f32,
    /// The camera.
    pub camera: Viewpoint,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Supersampling factor per axis.
    pub ssaa: u32,
    /// Center of the ball, meters.
    pub ball: Option<Vec3>,
    /// Whether only `ssaa` differs from the previous frame.
    pub again: bool,
    /// Quality of the frame.
    pub level: QualityLevel,
    /// Whether to submit the frame in parts because it takes long.
    pub parts: bool,
}

/// The displayed frame. The frame in flight may be a newer one.
pub struct DisplayedFrame {
    /// The texture, bound for painting.
    pub image: DisplayImage,
    /// The texture.
    view: wgpu::TextureView,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Supersampling factor per axis.
    pub ssaa: u32,
    /// Quality of the frame.
    pub level: QualityLevel,
    /// Number of drawn strands.
    pub strands: u32,
    /// Index of the frame, from 1.
    pub number: u64,
}

/// A character, its last frame, and at most one frame in flight.
pub struct CharacterDisplay {
    /// The character.
    pub stage: Scene,
    picture: Option<DisplayedFrame>,
    flight: Option<(Flight, QualityLevel)>,
    blit: Blit,
    /// Frames drawn so far.
    pub frames: u64,
    /// Duration of the last frame in milliseconds, from recording to completion.
    pub milliseconds: f32,
    /// GPU timestamps per stage, if the adapter's are meaningful.
    timings: Option<Timings>,
    /// Timestamps being read back.
    rows: Option<PendingTimings>,
    /// Milliseconds per stage of a recent frame.
    stages: Vec<(&'static str, f64)>,
    watcher: Watcher,
}

impl CharacterDisplay {
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

    /// Whether times per stage are available.
    pub fn times_stages(&self) -> bool {
        self.timings.is_some()
    }

    /// Returns the milliseconds per stage of a recent frame.
    pub fn stages(&self) -> &[(&'static str, f64)] {
        &self.stages
    }

    /// Replaces the character. Its first frame is still to be drawn.
    pub fn replace(&mut self, stage: Scene) {
        self.give_up();
        self.stage = stage;
    }

    /// Makes a frame that has finished the displayed one. Returns its duration in milliseconds.
    pub fn landed(&mut self) -> Option<f32> {
        let (flight, level) = self.flight.as_ref()?;
        let ms = flight.landed()?;
        let targets = self.stage.targets();
        let view = targets.picture();
        let image = match self.picture.take().filter(|picture| picture.view == *view) {
            Some(same) => same.image,
            None => self.blit.of(self.stage.gpu.context.device(), view),
        };
        self.picture = Some(DisplayedFrame {
            image,
            view: view.clone(),
            size: targets.size,
            ssaa: targets.ssaa,
            level: *level,
            strands: self.stage.detail().strand_count,
            number: self.frames,
        });
        self.flight = None;
        self.milliseconds = ms;
        Some(ms)
    }

    /// Cancels the frame in flight, if any, so that the next can start.
    pub fn give_up(&mut self) {
        if let Some((flight, _)) = self.flight.take() {
            flight.give_up();
        }
    }

    /// Whether a frame is in flight, as of the last call of [`landed`](Self::landed).
    pub fn is_in_flight(&self) -> bool {
        self.flight.is_some()
    }

    /// Returns the number of finished parts and of all parts of the frame in flight.
    pub fn progress(&self) -> Option<(usize, usize)> {
        self.flight.as_ref().map(|(flight, _)| flight.progress())
    }

    /// Returns the diameter of the hair in the viewport, pixels.
    pub fn hair_size(&self) -> f32 {
        let scale = self.picture.as_ref().map_or(1.0, |picture| picture.level.scale);
        self.stage.detail().size / scale
    }

    /// Returns strand and triangle counts and the memory of the groom.
    pub fn facts(&self) -> Facts {
        self.stage.facts()
    }

    /// Returns the last finished frame.
    pub fn picture(&self) -> Option<&DisplayedFrame> {
        self.picture.as_ref()
    }

    /// Draws a frame. The previous one must have [landed](Self::landed).
    pub fn draw(
        &mut self,
        state: &RenderState,
        context: &egui::Context,
        moment: &FrameContext,
    ) -> Result<()> {
        let started = Instant::now();
        let targets = self.stage.targets();
        if (targets.size, targets.ssaa) != (moment.size, moment.ssaa) {
            self.stage.resample(moment.size, moment.ssaa)?;
        }
        let mut encoder = state.device.create_command_encoder(&Default::default());
        self.stage.watch(&moment.camera);
        self.stage.set_ball(moment.ball, ball::RADIUS)?;
        if let Some(done) = self.rows.as_mut().and_then(PendingTimings::take) {
            (self.stages, self.rows) = (done?, None);
        }
        // Read back the timestamps of one frame at a time.
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
            self.stage.move_colliders();
            self.stage.record_draw(&mut encoder, timings.as_deref_mut(), &moment.camera)?;
        }
        if let Some(timings) = &timings {
            timings.resolve(&mut encoder);
        }
        let mut recorded = timings.map(Timings::parts).unwrap_or_default();
        recorded.push(encoder.finish());
        self.frames += 1;
        let context = context.clone();
        // A request without delay would paint the window twice.
        let wake = move || context.request_repaint_after(Duration::from_nanos(1));
        let flight = Flight::start(&state.queue, started, recorded, wake);
        if is_timed && let Some(timings) = &mut self.timings {
            self.rows = Some(timings.start_read(&self.stage.gpu.context));
        }
        self.watcher.watch(&flight);
        self.flight = Some((flight, moment.level));
        Ok(())
    }

    /// Starts reading back the guides. Returns the vertex-major positions to come, how many guides there are, and the
    /// map to groom space.
    pub fn guides(&self) -> (Pending, usize, Pose) {
        let character = &self.stage.character;
        let hair = character.hair();
        let back = character.head().inverse().after(&hair.simulation_transform());
        let pending = Pending::buffer(&self.stage.gpu.context, &hair.guides.current);
        (pending, hair.guides.count as usize, back)
    }

    /// Starts reading back the last finished frame.
    pub fn copy(&self) -> tresses::Result<Pending> {
        Pending::texture(&self.stage.gpu.context, self.stage.targets().picture().texture())
    }
}
