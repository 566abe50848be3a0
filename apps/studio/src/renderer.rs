//! Schedules frames of the hair and chooses their quality.

use crate::{
    cards::{BakedCards, CardPreview},
    messages::Messages,
    orbit::Orbit,
    pace::{Pace, QualityLevel},
    playback::Playback,
    stage::{CharacterDisplay, FrameContext},
};
use anyhow::Result;
use eframe::{egui, egui_wgpu::RenderState};
use std::time::Duration;
use tresses::{Gpu, glam::Vec3, low_level::DebugDisplay};
use tresses_scene::{Scene, Settings, camera::Angle};
use web_time::Instant;

/// Time without motion before a still image is refined.
const REST: Duration = Duration::from_millis(500);

/// Smallest width and height, pixels.
const MIN_SIZE: u32 = 16;

/// The character, its motion and camera, and the last frame.
pub struct StudioRenderer {
    context: egui::Context,
    state: RenderState,
    /// The window's device.
    pub gpu: Gpu,
    /// The character and its last frame; `None` until one is loaded.
    pub show: Option<CharacterDisplay>,
    /// Cards of the character; `None` until they are baked.
    pub cards: Option<CardPreview>,
    /// Transport, hand and ball.
    pub playback: Playback,
    /// The camera.
    pub orbit: Orbit,
    /// Quality levels and frame time.
    pub pace: Pace,
    /// The active debug view.
    pub debug: Option<DebugDisplay>,
    /// Whether something has changed since the last frame.
    pub dirty: bool,
    /// Size of the viewport, pixels.
    pub area: egui::Vec2,
    /// Time of the last motion, while a still image waits to be refined.
    rest: Option<Instant>,
}

impl StudioRenderer {
    /// Creates a renderer for the window of `context`, without a character.
    pub fn new(context: &egui::Context, state: RenderState, gpu: Gpu) -> Self {
        let orbit = Orbit::new(Angle::default(), (Vec3::new(-0.1, 1.4, -0.1), Vec3::new(0.1, 1.7, 0.1)));
        Self {
            context: context.clone(),
            state,
            playback: Playback::default(),
            orbit,
            pace: Pace::new(gpu.context.tier().software),
            gpu,
            show: None,
            cards: None,
            debug: None,
            dirty: true,
            area: egui::Vec2::ZERO,
            rest: None,
        }
    }

    /// Shows `stage` from the next frame on.
    pub fn present(&mut self, stage: Scene) {
        match &mut self.show {
            Some(show) => show.replace(stage),
            None => self.show = Some(CharacterDisplay::new(stage, &self.state)),
        }
        self.cards = None;
        self.dirty = true;
    }

    /// Shows the first level of `baked`, cards of the character.
    pub fn preview(&mut self, baked: BakedCards) {
        let Some(show) = &mut self.show else { return };
        // The strands are in the preview that is replaced.
        if let Some(old) = &mut self.cards {
            old.show(show, None);
        }
        show.give_up();
        self.cards = Some(CardPreview::new(baked, show));
        self.dirty = true;
    }

    /// Takes a finished frame and returns its duration in milliseconds. Call it before the window is painted: the
    /// finished frame does not wake the window again. `records`: the frame belongs to a recording.
    pub fn land(&mut self, records: bool) -> Option<f32> {
        let ms = self.show.as_mut()?.landed()?;
        self.dirty |= !records && self.pace.landed(ms);
        Some(ms)
    }

    /// Whether a frame can start: there is a character, and no frame is in flight. A frame that is `due` cancels the
    /// refinement of a still image. Also keeps touched hair moving.
    pub fn is_free(&mut self, due: bool) -> bool {
        let Some(show) = &mut self.show else { return false };
        self.playback.touch(show.stage.character.hair().grabbed().is_active());
        if show.is_in_flight() && due && self.pace.end_refinement() {
            show.give_up();
        }
        !show.is_in_flight()
    }

    /// Draws the next frame if one is `due` or the image can be refined. No frame may be in flight. `works`: a job is
    /// running.
    pub fn draw_next(&mut self, due: bool, works: bool, settings: &Settings, messages: &mut Messages) {
        if due {
            self.rest = None;
            self.pace.end_refinement();
        } else if !self.refines(works) {
            return;
        }
        let Some(show) = &mut self.show else { return };
        if let Some(cards) = &mut self.cards {
            self.dirty |= cards.follow(show);
        }
        if self.playback.play.take_reset() {
            self.playback.ball = None;
            show.stage.character.reset();
        }
        let seconds = self.playback.advance(self.gpu.context.tier().software);
        let level = self.pace.level();
        let drawn = show.picture().map(|picture| picture.level);
        let again = !due && self.debug.is_none() && drawn.is_some_and(|drawn| drawn.is_only_smoothed(level));
        let mut moment = self.prepare(level, settings, messages);
        if let Some(show) = &self.show {
            let solids = show.stage.character.solids();
            self.playback.ball = self.playback.ball.and_then(|ball| ball.advanced(seconds, &solids));
        }
        (moment.seconds, moment.again, moment.ball) =
            (seconds, again, self.playback.ball.map(|ball| ball.at));
        self.dirty = false;
        if let Err(error) = self.draw(&moment) {
            messages.fail(error);
            self.playback.play.playing = false;
        }
    }

    /// Applies the settings to the stage at `level`, before each frame. Returns a frame with a time step of zero.
    pub fn prepare(
        &mut self,
        level: &QualityLevel,
        settings: &Settings,
        messages: &mut Messages,
    ) -> FrameContext {
        if let Some(show) = &mut self.show {
            let dressed = level.apply(&mut show.stage, settings);
            if let Err(error) = dressed.and_then(|()| show.stage.show(self.debug)) {
                messages.fail(error);
            }
        }
        let pivot = self.show.as_ref().map_or(Vec3::ZERO, |show| show.stage.character.neck());
        let size = [self.area.x, self.area.y].map(|side| ((side * level.scale).round() as u32).max(MIN_SIZE));
        FrameContext {
            gesture: self.playback.gesture(pivot),
            seconds: 0.0,
            camera: self.orbit.camera(),
            size,
            ssaa: self.ssaa_at(level, size, settings),
            ball: self.playback.ball.map(|ball| ball.at),
            again: false,
            level: *level,
            parts: self.pace.is_long(level),
        }
    }

    /// Draws a frame. None may be in flight.
    ///
    /// # Errors
    /// Returns the library's errors.
    pub fn draw(&mut self, moment: &FrameContext) -> Result<()> {
        self.show.as_mut().map_or(Ok(()), |show| show.draw(&self.state, &self.context, moment))
    }

    /// Returns the supersampling factor per axis for an image of `size` at `level`. It exceeds the setting only within
    /// the adapter's texture size limit.
    pub fn ssaa_at(&self, level: &QualityLevel, size: [u32; 2], settings: &Settings) -> u32 {
        let max_factor = self.gpu.context.device().limits().max_texture_dimension_2d / size[0].max(size[1]);
        settings.ssaa.max(level.ssaa.min(max_factor))
    }

    /// Wakes the window in 5 ms, for work that ends without a callback.
    pub fn look_again(&self) {
        self.context.request_repaint_after(Duration::from_millis(5));
    }

    /// Whether to draw a still image again at a finer level now.
    fn refines(&mut self, works: bool) -> bool {
        if !self.may_refine(works) {
            self.rest = None;
            return false;
        }
        if self.pace.finishes() {
            return self.pace.refine();
        }
        let rested = self.rest.get_or_insert_with(Instant::now).elapsed();
        let Some(left) = REST.checked_sub(rested) else { return self.pace.refine() };
        self.context.request_repaint_after(left);
        false
    }

    /// Whether a still image can be refined: not during a job (`works`), nor while the pointer is down unless
    /// [`finish`](Self::finish) was called.
    pub fn may_refine(&self, works: bool) -> bool {
        let down = self.context.input(|input| input.pointer.any_down());
        !works && self.pace.can_refine() && (self.pace.finishes() || !down)
    }

    /// Stops the motion and refines the image to the finest level, until something moves.
    pub fn finish(&mut self) {
        self.playback.stop();
        self.pace.finish();
    }

    /// Whether [`finish`](Self::finish) would change the image.
    pub fn can_finish(&self) -> bool {
        let Some(show) = &self.show else { return false };
        let full = show.picture().is_some_and(|picture| self.pace.is_finest(&picture.level));
        !self.pace.finishes() && (self.playback.play.is_due() || !full)
    }

    /// Returns the progress of a refinement: finished parts, and all parts.
    pub fn refined(&self) -> Option<(usize, usize)> {
        let parts = self.show.as_ref()?.progress().filter(|(_, all)| *all > 1);
        parts.filter(|_| self.pace.refines())
    }

    /// Drops a ball on the head.
    pub fn drop_ball(&mut self) {
        if let Some(show) = &self.show {
            self.playback.drop_ball(show.stage.subject());
            self.dirty = true;
        }
    }

    /// Returns the duration of one period, seconds: of the character's animation, else of the motion.
    pub fn period(&self) -> f64 {
        let living = self.show.as_ref().and_then(|show| show.stage.character.rig());
        let animation = living.and_then(|living| living.duration()).filter(|length| *length > 0.0);
        animation.map_or_else(|| self.playback.play.period(), f64::from)
    }
}
