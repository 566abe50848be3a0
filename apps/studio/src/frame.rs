//! One picture of the hair: when it is due, what has moved since the last, and how finely it is drawn.

use crate::{
    app::Studio,
    ball::Ball,
    pace::Level,
    stage::{Moment, Show},
};
use eframe::egui;
use std::time::Duration;
use tresses::glam::Vec3;
use tresses_scene::Gesture;
use web_time::Instant;

/// The longest stretch of hair's time that one frame moves on by, seconds: on a GPU, on a software driver.
const LONGEST: (f32, f32) = (0.1, 1.0 / 30.0);

/// How long nothing has moved before the picture is refined.
const REST: Duration = Duration::from_millis(500);

/// Smallest picture, pixels.
const LEAST: u32 = 16;

/// The most of a frame that a hand on the head has for itself, seconds: hair has at most [`LONGEST`].
const FELT: f32 = 0.1;

/// How long hair that was touched swings while time stands still, seconds.
const AWAKE: f32 = 2.0;

impl Studio {
    /// A frame that is done is seen from here on. Before the window is painted: nothing else may wake it again.
    pub(crate) fn land(&mut self) {
        let Some(ms) = self.show.as_mut().and_then(Show::landed) else { return };
        self.panels.frames.push(ms);
        if self.recording.is_none() && self.pace.landed(ms) {
            self.dirty = true;
        }
    }

    /// Draws the hair if it moves or something has changed, and no frame is under way.
    pub(crate) fn draw(&mut self, context: &egui::Context) {
        let seconds = context.input(|input| input.stable_dt);
        if self.orbit.is_gliding() {
            self.orbit.advance(seconds);
            self.dirty = true;
        }
        let due = self.dirty || self.play.is_due() || self.is_live();
        if !due {
            self.last = None;
        }
        if self.lost().is_some() || self.area.min_elem() < 1.0 {
            return;
        }
        if !self.hand.is_still()
            || self.show.as_ref().is_some_and(|show| show.stage.hair.grabbed().is_active())
        {
            self.awake = AWAKE;
        }
        let Some(show) = &mut self.show else { return };
        if show.is_under_way() && due && self.pace.moved() {
            // What moves does not wait for a picture of what stood still.
            show.give_up();
        }
        if show.is_under_way() || self.record_on(context) || self.save_picture(context) {
            return;
        }
        if due {
            self.rest = None;
            self.pace.moved();
        } else if !self.refines(context) {
            return;
        }
        let Some(show) = &mut self.show else { return };
        let now = Instant::now();
        let real = self.last.map_or(1.0 / 60.0, |last| now.duration_since(last).as_secs_f32());
        self.last = Some(now);
        if self.play.take_reset() {
            self.ball = None;
            show.stage.rewind();
        }
        let most = if self.gpu.tier.software { LONGEST.1 } else { LONGEST.0 };
        // A hand moves in its own time: it shakes hair that stands still otherwise.
        let live = self.is_live();
        let hand = if live { real.min(most) } else { 0.0 };
        if live {
            // A head follows the pointer soon, however long frames are, and yet does not tear its hair.
            let felt = real.min(FELT);
            self.hand.advance(felt);
            self.awake -= felt;
        }
        let seconds = self.play.advance(real, most).max(hand);
        let level = self.pace.level();
        let drawn = self.show.as_ref().and_then(Show::picture).map(|picture| picture.level);
        let again = !due && self.view.is_none() && drawn.is_some_and(|drawn| drawn.is_only_smoothed(level));
        self.dress(level);
        let (gesture, camera, size) = (self.gesture(), self.orbit.camera(), self.size_at(level));
        let ssaa = self.ssaa_at(level, size);
        let Some(show) = &mut self.show else { return };
        let solids = show.stage.solids();
        self.ball = self.ball.and_then(|ball| ball.advanced(seconds, &solids));
        let ball = self.ball.map(|ball| ball.at);
        let (level, parts) = (*level, self.pace.is_long(level));
        let moment = Moment { gesture, seconds, camera, size, ssaa, ball, again, level, parts };
        self.dirty = false;
        if let Err(error) = show.draw(&self.state, context, &moment) {
            self.error = Some(format!("{error:#}"));
            self.play.playing = false;
        }
    }

    /// The size of a picture at `level`, pixels.
    pub(crate) fn size_at(&self, level: &Level) -> [u32; 2] {
        let size = self.area * level.scale;
        [size.x, size.y].map(|side| (side.round() as u32).max(LEAST))
    }

    /// Pixels drawn per pixel of such a picture, along each axis: more than the settings ask for only where the
    /// adapter has textures for it.
    pub(crate) fn ssaa_at(&self, level: &Level, size: [u32; 2]) -> u32 {
        let most = self.gpu.device.limits().max_texture_dimension_2d / size[0].max(size[1]);
        self.settings.now().edges.ssaa.max(level.ssaa.min(most))
    }

    /// Nothing is due: whether the picture is drawn once more, finer.
    fn refines(&mut self, context: &egui::Context) -> bool {
        if !self.may_refine(context) {
            self.rest = None;
            return false;
        }
        if self.pace.finishes() {
            return self.pace.refine();
        }
        let rested = self.rest.get_or_insert_with(Instant::now).elapsed();
        let Some(left) = REST.checked_sub(rested) else { return self.pace.refine() };
        context.request_repaint_after(left);
        false
    }

    /// Whether a still picture is refined: not while a pointer is down, unless it was asked for.
    pub(crate) fn may_refine(&self, context: &egui::Context) -> bool {
        let down = context.input(|input| input.pointer.any_down());
        self.job.is_none() && self.pace.can_refine() && (self.pace.finishes() || !down)
    }

    /// Stops the motion and draws the picture as finely as can be, however long it takes, unless something moves.
    pub(crate) fn finish(&mut self) {
        self.play.playing = false;
        self.awake = 0.0;
        self.pace.finish();
    }

    /// Whether [`finish`](Self::finish) would make it finer.
    pub(crate) fn can_finish(&self) -> bool {
        let Some(show) = &self.show else { return false };
        let full = show.picture().is_some_and(|picture| self.pace.is_finest(&picture.level));
        self.recording.is_none() && !self.pace.finishes() && (self.play.is_due() || !full)
    }

    /// How many parts of a picture that is being refined are done, of how many.
    pub(crate) fn refined(&self) -> Option<(usize, usize)> {
        let parts = self.show.as_ref()?.progress().filter(|(_, all)| *all > 1);
        parts.filter(|_| self.pace.refines() && self.recording.is_none())
    }

    /// Lets a ball fall on the head.
    pub(crate) fn drop_ball(&mut self) {
        if let Some(show) = &self.show {
            self.ball = Some(Ball::dropped(show.stage.subject(), self.balls));
            self.balls += 1;
            self.play.playing = true;
            self.dirty = true;
        }
    }

    /// What the character does now.
    pub(crate) fn gesture(&self) -> Gesture {
        let pivot = self.pivot();
        self.hand.apply(self.play.gesture(pivot), pivot)
    }

    /// What the head turns about, metres.
    pub(crate) fn pivot(&self) -> Vec3 {
        self.show.as_ref().map_or(Vec3::ZERO, |show| show.stage.pivot())
    }

    /// Whether the user is dragging head or hair, or was until just now.
    pub(crate) fn is_live(&self) -> bool {
        self.awake > 0.0 || !self.hand.is_still()
    }
}
