//! Motion of the character: the transport, a hand on the head, a ball.

use crate::{ball::Ball, head::HeadSpring, play::Play};
use tresses::glam::Vec3;
use tresses::{Bounds, Gesture};
use web_time::Instant;

/// Longest time step of the hair, seconds: on a GPU, and with a software driver.
const LONGEST: (f32, f32) = (0.1, 1.0 / 30.0);

/// Longest time step of the hand, seconds.
const FELT: f32 = 0.1;

/// Time for which touched hair keeps moving while the motion is paused, seconds.
const AWAKE: f32 = 2.0;

/// Motion of the character.
#[derive(Debug, Default)]
pub struct Playback {
    /// The transport.
    pub play: Play,
    /// The hand that drags the head.
    pub hand: HeadSpring,
    /// The falling ball.
    pub ball: Option<Ball>,
    /// Number of balls dropped so far.
    balls: u32,
    /// Remaining seconds for which touched hair keeps moving while the motion is paused.
    awake: f32,
    /// Start of the last frame, while frames are due.
    last: Option<Instant>,
    /// Whether the body and its hair are at rest, whatever the transport does, for grooming.
    pub at_rest: bool,
    /// Whether hair moves while the transport is paused and the body is at rest, for brushes on moving hair.
    pub live: bool,
}

impl Playback {
    /// Whether a frame is due because something moves.
    pub fn is_due(&self) -> bool {
        !self.at_rest && (self.play.is_due() || self.is_live())
    }

    /// Whether hair moves while the transport is paused: the user is dragging it or the head, or was until recently.
    pub fn is_live(&self) -> bool {
        self.live || self.awake > 0.0 || !self.hand.is_still()
    }

    /// Returns the character's gesture; the head turns about `pivot`, meters.
    pub fn gesture(&self, pivot: Vec3) -> Gesture {
        if self.at_rest {
            return Gesture::default();
        }
        let is_held = self.live && !self.play.playing;
        let gesture = if is_held { Gesture::default() } else { self.play.gesture(pivot) };
        self.hand.apply(gesture, pivot)
    }

    /// Stops the clock until a frame is due.
    pub fn rest(&mut self) {
        self.last = None;
    }

    /// Keeps hair moving while a hand is on the head or hair is `grabbed`.
    pub fn touch(&mut self, grabbed: bool) {
        if grabbed || !self.hand.is_still() {
            self.awake = AWAKE;
        }
    }

    /// Pauses the transport and ends the motion of touched hair.
    pub fn stop(&mut self) {
        self.play.playing = false;
        (self.awake, self.live) = (0.0, false);
    }

    /// Drops a ball on `subject`.
    pub fn drop_ball(&mut self, subject: Bounds) {
        self.ball = Some(Ball::dropped(subject, self.balls));
        self.balls += 1;
        self.play.playing = true;
    }

    /// Advances the transport and the hand to a frame that starts now. Returns the hair's time step, seconds. Its limit
    /// is shorter with a `software` driver.
    pub fn advance(&mut self, software: bool) -> f32 {
        if self.at_rest {
            self.last = None;
            return 0.0;
        }
        let now = Instant::now();
        let real = self.last.map_or(1.0 / 60.0, |last| now.duration_since(last).as_secs_f32());
        self.last = Some(now);
        let max_step = if software { LONGEST.1 } else { LONGEST.0 };
        // The hand moves in real time, also while the motion is paused.
        let live = self.is_live();
        let hand = if live { real.min(max_step) } else { 0.0 };
        if live {
            // The limit lets the head follow the pointer at low frame rates without jerking the hair.
            let felt = real.min(FELT);
            self.hand.advance(felt);
            self.awake -= felt;
        }
        self.play.advance(real, max_step).max(hand)
    }
}
