//! The character in the window: the only file that talks to the renderer, a frame into a texture at a time.

use crate::ball;
use anyhow::Result;
use eframe::{
    egui::{self, TextureId},
    egui_wgpu::RenderState,
};
use std::sync::{Arc, Mutex, PoisonError};
use tresses::{
    Pose,
    glam::Vec3,
    gpu::{Timings, readback::Pending, timings::Rows},
};
use tresses_scene::{Facts, Scene, Viewpoint};
use web_time::Instant;

/// What a frame is made for.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Where the head is.
    pub pose: Pose,
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
}

/// When a frame's work was done, and whether it is.
type Landed = Arc<Mutex<Option<Instant>>>;

/// A character, the texture it is drawn into, and at most one frame under way.
pub struct Show {
    /// The character.
    pub stage: Scene,
    texture: Option<TextureId>,
    flight: Option<(Instant, Landed)>,
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
    /// Shows `stage`.
    pub fn new(stage: Scene) -> Self {
        let gpu = &stage.gpu;
        let watcher = Watcher::new(&gpu.device);
        let timed = gpu.tier.timestamps && !gpu.tier.software;
        let timings = timed.then(|| Timings::new(&gpu.device, &gpu.queue));
        let (rows, stages) = (None, Vec::new());
        Self {
            stage,
            texture: None,
            flight: None,
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

    /// Another character into the same texture.
    pub fn replace(&mut self, stage: Scene) {
        self.stage = stage;
    }

    /// Whether a frame is under way; one that has landed gives its milliseconds.
    pub fn landed(&mut self) -> (bool, Option<f32>) {
        let Some((begun, landed)) = &self.flight else { return (false, None) };
        let Some(end) = *landed.lock().unwrap_or_else(PoisonError::into_inner) else { return (true, None) };
        let ms = end.duration_since(*begun).as_secs_f32() * 1e3;
        self.flight = None;
        self.milliseconds = ms;
        (false, Some(ms))
    }

    /// Whether a frame is under way, as far as one has looked.
    pub fn is_under_way(&self) -> bool {
        self.flight.is_some()
    }

    /// Sizes of what is drawn.
    pub fn facts(&self) -> Facts {
        self.stage.facts()
    }

    /// The texture with the last frame.
    pub fn texture(&self) -> Option<TextureId> {
        self.texture
    }

    /// Draws a frame; the one before must have [landed](Self::landed).
    pub fn draw(&mut self, state: &RenderState, context: &egui::Context, moment: &Moment) -> Result<()> {
        let begun = Instant::now();
        let targets = self.stage.targets();
        if (targets.size, targets.ssaa) != (moment.size, moment.ssaa) || self.texture.is_none() {
            self.stage.resample(moment.size, moment.ssaa)?;
        }
        self.register(state);
        let mut encoder = state.device.create_command_encoder(&Default::default());
        self.stage.watch(&moment.camera);
        self.stage.set_ball(moment.ball, ball::RADIUS)?;
        if let Some(done) = self.rows.as_mut().and_then(Rows::take) {
            (self.stages, self.rows) = (done?, None);
        }
        // One frame's times at a time.
        let mut timings = self.timings.as_mut().filter(|_| self.rows.is_none());
        if moment.again {
            self.stage.record_redraw(&mut encoder, timings.as_deref_mut())?;
        } else {
            self.stage.record_advance(&mut encoder, timings.as_deref_mut(), &moment.pose, moment.seconds)?;
            self.stage.place_colliders();
            self.stage.record_draw(&mut encoder, timings.as_deref_mut(), &moment.camera)?;
        }
        if let Some(timings) = &timings {
            timings.resolve(&mut encoder);
        }
        state.queue.submit([encoder.finish()]);
        if let Some(timings) = timings {
            self.rows = Some(timings.later(&state.device, &state.queue));
        }
        self.frames += 1;
        let landed = Landed::default();
        let (tell, context) = (landed.clone(), context.clone());
        state.queue.on_submitted_work_done(move || {
            *tell.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
            context.request_repaint();
        });
        self.watcher.watch(&landed);
        self.flight = Some((begun, landed));
        Ok(())
    }

    /// The picture that is drawn or being drawn, on its way to the CPU.
    pub fn copy(&self) -> tresses::Result<Pending> {
        let gpu = &self.stage.gpu;
        Pending::texture(&gpu.device, &gpu.queue, self.stage.targets().picture().texture())
    }

    /// egui knows the targets' picture by one name, whatever its size.
    fn register(&mut self, state: &RenderState) {
        let view = self.stage.targets().picture();
        let filter = wgpu::FilterMode::Linear;
        let mut renderer = state.renderer.write();
        match self.texture {
            Some(id) => renderer.update_egui_texture_from_wgpu_texture(&state.device, view, filter, id),
            None => self.texture = Some(renderer.register_native_texture(&state.device, view, filter)),
        }
    }
}

/// A device calls back when somebody asks it: a thread does while a frame is under way.
#[cfg(not(target_arch = "wasm32"))]
struct Watcher(std::sync::mpsc::Sender<Landed>);

#[cfg(not(target_arch = "wasm32"))]
impl Watcher {
    fn new(device: &wgpu::Device) -> Self {
        let (sender, receiver) = std::sync::mpsc::channel::<Landed>();
        let device = device.clone();
        std::thread::spawn(move || {
            while let Ok(landed) = receiver.recv() {
                while landed.lock().unwrap_or_else(PoisonError::into_inner).is_none() {
                    // Waiting inside the device would keep the window from handing in work.
                    if device.poll(wgpu::PollType::Poll).is_err() {
                        return;
                    }
                    std::thread::sleep(std::time::Duration::from_millis(1));
                }
            }
        });
        Self(sender)
    }

    fn watch(&self, landed: &Landed) {
        // Without the thread the device is lost, and somebody has said so.
        let _ = self.0.send(landed.clone());
    }
}

/// A browser calls back by itself.
#[cfg(target_arch = "wasm32")]
struct Watcher;

#[cfg(target_arch = "wasm32")]
impl Watcher {
    fn new(_: &wgpu::Device) -> Self {
        Self
    }

    fn watch(&self, _: &Landed) {}
}
