//! Motion of the character: the transport, a hand on the head, a ball.

use crate::{ball::Ball, head::Hand, play::Play};
use tresses::character::{Bounds, Gesture};
use tresses::glam::Vec3;
use web_time::Instant;

/// The longest time step of the hair, seconds: on a GPU, on a software driver.
const LONGEST: (f32, f32) = (0.1, 1.0 / 30.0);

/// The longest time step of the hand, seconds.
const FELT: f32 = 0.1;

/// How long hair that was touched swings while time stands still, seconds.
const AWAKE: f32 = 2.0;

/// The motion of the character.
#[derive(Debug, Default)]
pub struct Playback {
    /// The transport.
    pub play: Play,
    /// A hand on the head.
    pub hand: Hand,
    /// A falling ball.
    pub ball: Option<Ball>,
    /// Number of balls so far.
    balls: u32,
    /// Seconds for which touched hair swings on while time stands still.
    awake: f32,
    /// Start of the last frame, while frames are due.
    last: Option<Instant>,
}

impl Playback {
    /// Whether a frame is due because something moves.
    pub fn is_due(&self) -> bool {
        self.play.is_due() || self.is_live()
    }

    /// Whether the user is dragging head or hair, or was until just now.
    pub fn is_live(&self) -> bool {
        self.awake > 0.0 || !self.hand.is_still()
    }

    /// The character's gesture now; the head turns about `pivot`, meters.
    pub fn gesture(&self, pivot: Vec3) -> Gesture {
        self.hand.apply(self.play.gesture(pivot), pivot)
    }

    /// Stops the clock until a frame is due.
    pub fn rest(&mut self) {
        self.last = None;
    }

    /// Keeps hair awake while a hand is on the head or hair is `grabbed`.
    pub fn touch(&mut self, grabbed: bool) {
        if grabbed || !self.hand.is_still() {
            self.awake = AWAKE;
        }
    }

    /// Pauses the transport and ends the swing of touched hair.
    pub fn stop(&mut self) {
        self.play.playing = false;
        self.awake = 0.0;
    }

    /// Drops a ball on `subject`.
    pub fn drop_ball(&mut self, subject: Bounds) {
        self.ball = Some(Ball::dropped(subject, self.balls));
        self.balls += 1;
        self.play.playing = true;
    }

    /// Advances transport and hand to a frame that begins now. Returns the hair's time step, seconds. A `software`
    /// driver has a shorter one.
    pub fn advance(&mut self, software: bool) -> f32 {
        let now = Instant::now();
        let real = self.last.map_or(1.0 / 60.0, |last| now.duration_since(last).as_secs_f32());
        self.last = Some(now);
        let most = if software { LONGEST.1 } else { LONGEST.0 };
        // A hand moves in its own time: it shakes hair that stands still otherwise.
        let live = self.is_live();
        let hand = if live { real.min(most) } else { 0.0 };
        if live {
            // A head follows the pointer soon, however long frames are, and yet does not tear its hair.
            let felt = real.min(FELT);
            self.hand.advance(felt);
            self.awake -= felt;
        }
        self.play.advance(real, most).max(hand)
    }
}
