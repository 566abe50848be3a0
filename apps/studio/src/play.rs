//! The transport: play state, speed, and the time of the motion.

use tresses::Gesture;
use tresses::glam::Vec3;
use tresses_scene::motion::Motion;

/// Duration of a single step, seconds.
pub const STEP: f32 = 1.0 / 60.0;
/// Duration of the blend from one motion to another, seconds.
const CHANGE: f32 = 0.6;
/// Range of the speed.
pub const SPEEDS: std::ops::RangeInclusive<f32> = 0.05..=2.0;

/// The transport of the studio.
#[derive(Clone, Debug)]
pub struct Play {
    /// Whether the motion plays.
    pub playing: bool,
    /// Simulated seconds per real second.
    pub speed: f32,
    /// Name of the motion.
    pub name: String,
    motion: Option<Motion>,
    /// The previous motion, its time, and the progress of the blend, 0 to 1.
    leaving: Option<(Motion, f64, f32)>,
    /// Seconds since the start of the motion.
    pub time: f64,
    /// Requested single steps.
    steps: u32,
    /// Whether a reset of the hair was requested.
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
    /// Starts another built-in motion. The head blends to it without a jump.
    pub fn set_motion(&mut self, name: &str) {
        self.leaving = self.motion.take().map(|motion| (motion, self.time, 0.0));
        self.motion = Motion::named(name);
        self.name = name.into();
        self.time = 0.0;
    }

    /// Requests a single step and pauses.
    pub fn step(&mut self) {
        self.playing = false;
        self.steps += 1;
    }

    /// Requests a reset of the hair, and rewinds the motion.
    pub fn reset(&mut self) {
        self.reset = true;
        self.begin();
    }

    /// Rewinds the motion and drops the blend from the previous one.
    pub fn begin(&mut self) {
        (self.leaving, self.time) = (None, 0.0);
    }

    /// Takes the request for a reset of the hair.
    pub fn take_reset(&mut self) -> bool {
        std::mem::take(&mut self.reset)
    }

    /// Whether a frame is due.
    pub fn is_due(&self) -> bool {
        self.playing || self.steps > 0 || self.reset
    }

    /// Advances to a frame `real` seconds after the last. Returns the simulated time step, `most` seconds or less while
    /// playing.
    pub fn advance(&mut self, real: f32, max_step: f32) -> f32 {
        let dt = if self.playing { (real * self.speed).min(max_step) } else { STEP * self.steps as f32 };
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

    /// Returns the duration of one period of the motion, seconds.
    pub fn period(&self) -> f64 {
        self.motion.as_ref().map_or(1.0, Motion::duration)
    }

    /// Returns the character's gesture; its head turns about `pivot`.
    pub fn gesture(&self, pivot: Vec3) -> Gesture {
        let now =
            self.motion.as_ref().map_or_else(Gesture::default, |motion| motion.gesture(self.time, pivot));
        let Some((before, at, done)) = &self.leaving else { return now };
        // Both motions advance during the blend, so velocities are continuous too.
        before.gesture(*at, pivot).lerp(&now, done * done * (3.0 - 2.0 * done))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::Pose;

    #[test]
    fn changing_the_motion_does_not_jerk_the_head() {
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
        play.set_motion("still");
        let fastest = run(&mut play, 60);
        assert_eq!(play.gesture(pivot).rigid(), Pose::IDENTITY);
        assert!(turned > 3.0 * usual, "a jump would be seen: {turned}, {usual} radians");
        assert!(fastest < 1.5 * usual, "{fastest} radians in a step, {usual} in the motion itself");
        play.set_motion("turn");
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
