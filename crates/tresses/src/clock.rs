//! Fixed steps from real time.
//!
//! A frame passes in the time since the last one and the current pose of the head; the result is the fixed
//! steps to simulate and the interpolation factor of the drawn state between the last two. The head's
//! motion within the frame is divided among the steps, so that the hair sees the same motion at any frame
//! rate. Poses are those of the frame's [`Space`](crate::space::Space): a head that is carried along by it does not
//! move.

use crate::{Pose, math::map::Map};
use glam::Vec3;

/// The most fixed steps of one frame.
pub const MAX_STEPS: u32 = 8;
/// The most substeps of one step.
pub const MAX_SUBSTEPS: u32 = 32;

/// What a step does.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Simulates.
    #[default]
    Step = 0,
    /// Carries every strand rigidly with the head, velocities too.
    Carry = 1,
    /// Puts every strand into its rest pose, without velocity relative to the world.
    Reset = 2,
}

/// One fixed step of a frame: where the head is when it begins and when it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// What it does.
    pub mode: Mode,
    /// Pose of the head at the start.
    pub begin: Pose,
    /// Pose of the head at the end.
    pub end: Pose,
    /// Where in the frame's motion it begins, 0..=1.
    pub from: f32,
    /// Where in the frame's motion it ends, 0..=1.
    pub to: f32,
}

impl Step {
    /// How fast the head goes in it, m/s, if it takes `length` seconds.
    pub(crate) fn drift(&self, length: f32) -> Vec3 {
        (self.end.translation - self.begin.translation) / length.max(1e-6)
    }
}

/// The fixed steps of a frame with their lengths.
#[derive(Clone, Copy, Debug)]
pub struct Steps<'a> {
    /// The steps, in order.
    pub steps: &'a [Step],
    /// Length of each, s.
    pub length: f32,
    /// Implicit solves of each.
    pub substeps: u32,
}

impl<'a> Steps<'a> {
    /// The last [`MAX_STEPS`] of them.
    pub(crate) fn last(&self) -> &'a [Step] {
        &self.steps[self.steps.len().saturating_sub(MAX_STEPS as usize)..]
    }
}

/// Turns frames into fixed steps.
#[derive(Clone, Debug)]
pub struct Clock {
    /// A head that moves farther than this in one fixed step, metres, is teleported: the hair is
    /// carried along rigidly.
    pub teleport_distance: f32,
    /// The same for a turn, radians.
    pub teleport_angle: f32,
    accumulator: f64,
    /// The head's pose at the end of the last step.
    state: Option<Pose>,
    reset: bool,
}

impl Default for Clock {
    fn default() -> Self {
        Self { teleport_distance: 0.3, teleport_angle: 1.0, accumulator: 0.0, state: None, reset: false }
    }
}

/// What a frame has to do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ticks {
    /// The steps, in order.
    pub steps: Vec<Step>,
    /// What is drawn lies at this fraction from the state before the last step to the one after it.
    pub alpha: f32,
    /// Time of the frame that was left out because it was too long, s.
    pub skipped: f32,
}

impl Clock {
    /// The next frame starts from the rest pose.
    pub fn reset(&mut self) {
        self.reset = true;
    }

    /// The head's pose at the end of the last step, unless the next frame starts from the rest pose.
    pub(crate) fn state(&self) -> Option<&Pose> {
        self.state.as_ref().filter(|_| !self.reset)
    }

    /// Poses are given in another space from here on, to which `map` leads.
    pub(crate) fn enter(&mut self, map: &Map) {
        self.state = self.state.map(|state| map.pose(&state));
    }

    /// How many steps, of `step` seconds, it is from [`state`](Self::state) to the end of a frame of `dt` seconds.
    pub(crate) fn steps_to(&self, dt: f64, step: f64) -> f32 {
        ((self.accumulator + dt) / step).clamp(1.0, MAX_STEPS.into()) as f32
    }

    /// Whether a head that goes from `at` to `head` in so many steps is teleported.
    pub(crate) fn jumps(&self, at: &Pose, head: &Pose, steps: f32) -> bool {
        let distance = at.translation.distance(head.translation);
        let angle = at.rotation.angle_between(head.rotation);
        distance > self.teleport_distance * steps
            || angle > self.teleport_angle * steps
            || !distance.is_finite()
    }

    /// How far it is from `at` to `head`, in steps of a head that is nearly teleported.
    pub(crate) fn way(&self, at: &Pose, head: &Pose) -> f32 {
        let distance = at.translation.distance(head.translation) / self.teleport_distance;
        distance.max(at.rotation.angle_between(head.rotation) / self.teleport_angle)
    }

    /// The steps, each `step` seconds, of a frame that came `dt` seconds after the last one with
    /// the head now at `head`. A `dt` that is negative or no number counts as 0, and of one that
    /// is longer than [`MAX_STEPS`] steps the rest is skipped, which [`Ticks::skipped`] says.
    pub fn tick(&mut self, dt: f32, step: f32, head: &Pose) -> Ticks {
        let whole = |mode| Step { mode, begin: *head, end: *head, from: 0.0, to: 1.0 };
        let Some(at) = self.state.filter(|_| !self.reset) else {
            self.reset = false;
            self.accumulator = 0.0;
            self.state = Some(*head);
            return Ticks { steps: vec![whole(Mode::Reset)], alpha: 1.0, skipped: 0.0 };
        };
        let step = f64::from(step.clamp(1e-4, 0.1));
        let dt = if dt.is_finite() { f64::from(dt.max(0.0)) } else { 0.0 };
        let before = self.accumulator;
        // Just below a whole step counts as one: 1/60 s is not a sum of binary fractions.
        let due = ((before + dt) / step + 1e-4).floor();
        let count = due.min(f64::from(MAX_STEPS));
        let skipped = (due - count) * step;
        self.accumulator = (before + dt - due * step).max(0.0);
        // The last step ends this long before the frame's time.
        let lag = self.accumulator;
        let span = (before + dt - skipped).max(1e-9);
        let mut steps = Vec::with_capacity(count as usize);
        if self.jumps(&at, head, (span / step).max(1.0) as f32) {
            steps.push(Step { mode: Mode::Carry, begin: at, end: *head, from: 0.0, to: 0.0 });
            self.state = Some(*head);
            self.accumulator = 0.0;
            return Ticks { steps, alpha: 1.0, skipped: (skipped + count * step) as f32 };
        }
        let mut begin = at;
        for i in 1..=count as u32 {
            let done = f64::from(i) * step / span;
            let end = if i == count as u32 && lag < 1e-3 * step {
                *head
            } else {
                at.lerp(head, done.min(1.0) as f32)
            };
            let from = (done - step / span).max(0.0) as f32;
            steps.push(Step { mode: Mode::Step, begin, end, from, to: done.min(1.0) as f32 });
            begin = end;
        }
        self.state = Some(begin);
        Ticks { steps, alpha: (lag / step).min(1.0) as f32, skipped: skipped as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn at(x: f32) -> Pose {
        Pose { translation: Vec3::X * x, ..Pose::IDENTITY }
    }

    #[test]
    fn the_same_number_of_steps_at_any_frame_rate() {
        for rate in [24.0f32, 30.0, 60.0, 90.0, 144.0, 1000.0] {
            let mut clock = Clock::default();
            let mut steps = clock.tick(0.0, 1.0 / 60.0, &at(0.0)).steps;
            assert_eq!(steps.remove(0).mode, Mode::Reset);
            let mut end = at(0.0);
            for i in 1..=(rate * 2.0) as u32 {
                let ticks = clock.tick(1.0 / rate, 1.0 / 60.0, &at(0.1 * i as f32 / rate));
                assert!((0.0..=1.0).contains(&ticks.alpha) && ticks.skipped == 0.0);
                for step in ticks.steps {
                    assert_eq!((step.mode, step.begin), (Mode::Step, end));
                    end = step.end;
                    steps.push(step);
                }
            }
            assert!(steps.len().abs_diff(120) <= 1, "{rate}: {}", steps.len());
            for step in &steps {
                let way = step.end.translation.x - step.begin.translation.x;
                assert!((way - 0.1 / 60.0).abs() < 0.1 * 0.1 / 60.0, "{rate}: {way}");
            }
        }
    }

    #[test]
    fn long_frames_are_cut_and_jumps_are_carried() {
        let mut clock = Clock::default();
        clock.tick(0.0, 1.0 / 60.0, &at(0.0));
        let ticks = clock.tick(2.0, 1.0 / 60.0, &at(0.2));
        assert_eq!(ticks.steps.len(), MAX_STEPS as usize);
        assert!((ticks.skipped - (2.0 - 8.0 / 60.0)).abs() < 0.02);
        assert_eq!(ticks.steps.last().map(|s| s.to > 0.99), Some(true));
        let ticks = clock.tick(1.0 / 60.0, 1.0 / 60.0, &at(5.0));
        assert_eq!(ticks.steps[0].mode, Mode::Carry);
        assert_eq!(ticks.steps[0].end, at(5.0));
        assert!(clock.tick(f32::NAN, 1.0 / 60.0, &at(5.0)).steps.is_empty());
        clock.reset();
        assert_eq!(clock.tick(0.1, 1.0 / 60.0, &at(0.0)).steps[0].mode, Mode::Reset);
    }
}
