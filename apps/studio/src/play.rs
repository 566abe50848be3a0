//! Time: what plays, how fast, and where the motion is.

use tresses::character::Gesture;
use tresses::glam::Vec3;
use tresses_scene::motion::Motion;

/// What a single step takes, seconds.
pub const STEP: f32 = 1.0 / 60.0;
/// How long the head takes from one motion to another, seconds.
const CHANGE: f32 = 0.6;
/// Slowest and fastest.
pub const SPEEDS: std::ops::RangeInclusive<f32> = 0.05..=2.0;

/// The transport of the studio.
#[derive(Clone, Debug)]
pub struct Play {
    /// Whether time goes by.
    pub playing: bool,
    /// Seconds of hair per second of the clock.
    pub speed: f32,
    /// The name of the motion.
    pub name: String,
    motion: Option<Motion>,
    /// The motion before it, where that was, and how much of the way to the new one is done.
    leaving: Option<(Motion, f64, f32)>,
    /// Seconds since the motion's begin.
    pub time: f64,
    /// Single steps that are due.
    steps: u32,
    /// Whether the hair is to be put to rest.
    reset: bool,
}

impl Default for Play {
    fn default() -> Self {
        let name = "turn";
        Self {
            playing: true,
            speed: 1.0,
            name: name.into(),
            motion: Motion::named(name),
            leaving: None,
            time: 0.0,
            steps: 0,
            reset: false,
        }
    }
}

impl Play {
    /// Another built-in motion, from its begin. The head does not jump there.
    pub fn choose(&mut self, name: &str) {
        self.leaving = self.motion.take().map(|motion| (motion, self.time, 0.0));
        self.motion = Motion::named(name);
        self.name = name.into();
        self.time = 0.0;
    }

    /// One step is due; time stops.
    pub fn step(&mut self) {
        self.playing = false;
        self.steps += 1;
    }

    /// The hair is to be put to rest, and the motion to its begin.
    pub fn reset(&mut self) {
        self.reset = true;
        self.begin();
    }

    /// The motion is at its begin, whatever was before.
    pub fn begin(&mut self) {
        (self.leaving, self.time) = (None, 0.0);
    }

    /// Whether the hair is to be put to rest; asked once.
    pub fn take_reset(&mut self) -> bool {
        std::mem::take(&mut self.reset)
    }

    /// Whether a frame is due although nothing plays.
    pub fn is_due(&self) -> bool {
        self.playing || self.steps > 0 || self.reset
    }

    /// The seconds that go by in a frame `real` seconds after the last, of which a device manages `most`.
    pub fn advance(&mut self, real: f32, most: f32) -> f32 {
        let dt = if self.playing { (real * self.speed).min(most) } else { STEP * self.steps as f32 };
        self.steps = 0;
        self.time += f64::from(dt);
        if let Some((_, at, done)) = &mut self.leaving {
            *at += f64::from(dt);
            *done += dt / CHANGE;
            if *done >= 1.0 {
                self.leaving = None;
            }
        }
        dt
    }

    /// Seconds of a run of the motion.
    pub fn period(&self) -> f64 {
        self.motion.as_ref().map_or(1.0, Motion::duration)
    }

    /// What the character does now; its head turns about `pivot`.
    pub fn gesture(&self, pivot: Vec3) -> Gesture {
        let now =
            self.motion.as_ref().map_or_else(Gesture::default, |motion| motion.gesture(self.time, pivot));
        let Some((before, at, done)) = &self.leaving else { return now };
        // Both go on meanwhile: velocities are continuous too.
        before.gesture(*at, pivot).lerp(&now, done * done * (3.0 - 2.0 * done))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::Pose;

    #[test]
    fn another_motion_does_not_jerk_the_head() {
        let mut play = Play::default();
        let pivot = Vec3::Y;
        let run = |play: &mut Play, steps: u32| {
            let mut most = 0.0f32;
            for _ in 0..steps {
                let before = play.gesture(pivot).rigid().rotation;
                play.advance(STEP, 1.0);
                most = most.max(before.angle_between(play.gesture(pivot).rigid().rotation));
            }
            most
        };
        let usual = run(&mut play.clone(), 300);
        run(&mut play, 30);
        let turned = play.gesture(pivot).rigid().rotation.angle_between(Pose::IDENTITY.rotation);
        play.choose("still");
        let fastest = run(&mut play, 60);
        assert_eq!(play.gesture(pivot).rigid(), Pose::IDENTITY);
        assert!(turned > 3.0 * usual, "a jump would be seen: {turned}, {usual} radians");
        assert!(fastest < 1.5 * usual, "{fastest} radians in a step, {usual} in the motion itself");
        play.choose("turn");
        play.reset();
        assert_eq!(play.gesture(pivot).rigid(), Pose::IDENTITY);
    }

    #[test]
    fn time_stops_and_steps() {
        let mut play = Play { speed: 0.5, ..Play::default() };
        assert_eq!(play.advance(0.02, 1.0), 0.01);
        assert_eq!(play.advance(9.0, 0.05), 0.05);
        play.playing = false;
        assert!(!play.is_due() && play.advance(1.0, 1.0) == 0.0);
        play.step();
        assert!(play.is_due());
        assert_eq!((play.advance(1.0, 1.0), play.advance(1.0, 1.0)), (STEP, 0.0));
        play.reset();
        assert!(play.take_reset() && !play.take_reset() && play.time == 0.0);
    }
}
