//! The fixed-step clock: turns frame times into fixed simulation steps.
//!
//! A frame supplies the time since the last one and the current pose of the head. The clock returns the fixed steps to
//! simulate, and the fraction at which the drawn state is interpolated between the last two states. The head's motion
//! within the frame is divided among the steps, so hair moves the same at any frame rate. Poses are relative to the
//! frame's [`Space`](crate::space::Space): a head that is carried along by its space does not move.

use crate::{Pose, math::map::Map};
use glam::Vec3;

/// Maximum fixed steps per frame.
pub const MAX_STEPS: u32 = 8;
/// Maximum substeps per step.
pub const MAX_SUBSTEPS: u32 = 32;

/// Kind of a step.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Simulates the hair.
    #[default]
    Step = 0,
    /// Carries every strand rigidly with the head, including its velocity.
    Rigid = 1,
    /// Puts every strand into its rest pose, with zero velocity in the world.
    Reset = 2,
}

/// One fixed step of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Kind of the step.
    pub mode: Mode,
    /// Pose of the head at the start.
    pub begin: Pose,
    /// Pose of the head at the end.
    pub end: Pose,
    /// Fraction of the frame's motion at the start, 0..=1.
    pub from: f32,
    /// Fraction of the frame's motion at the end, 0..=1.
    pub to: f32,
}

impl Step {
    /// Returns the head's mean velocity in the step, m/s. `length` is the step's length in seconds.
    pub(crate) fn drift(&self, length: f32) -> Vec3 {
        (self.end.translation - self.begin.translation) / length.max(1e-6)
    }
}

/// The fixed steps of a frame and their length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps<'a> {
    /// The steps, in order.
    pub steps: &'a [Step],
    /// Length of each step, s.
    pub length: f32,
    /// Substeps of each step: implicit solves.
    pub substeps: u32,
}

impl<'a> Steps<'a> {
    /// Returns the last [`MAX_STEPS`] steps.
    pub(crate) fn last(&self) -> &'a [Step] {
        &self.steps[self.steps.len().saturating_sub(MAX_STEPS as usize)..]
    }
}

/// Fixed-step clock.
#[derive(Clone, Debug)]
pub(crate) struct StepClock {
    /// Largest translation of the head in one fixed step, meters. Above it the motion is a teleport: the hair is
    /// carried along rigidly.
    pub teleport_distance: f32,
    /// Largest rotation of the head in one fixed step without a teleport, radians.
    pub teleport_angle: f32,
    accumulator: f64,
    /// Pose of the head at the end of the last step.
    state: Option<Pose>,
    reset: bool,
    /// Whether the next frame is a teleport, whatever the distance.
    teleports: bool,
}

impl Default for StepClock {
    fn default() -> Self {
        Self {
            teleport_distance: 0.3,
            teleport_angle: 1.0,
            accumulator: 0.0,
            state: None,
            reset: false,
            teleports: false,
        }
    }
}

/// The fixed steps that a frame runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ticks {
    /// The steps, in order.
    pub steps: Vec<Step>,
    /// Interpolation fraction of the drawn state: 0 is the state before the last step, 1 the state after it.
    pub alpha: f32,
    /// Time dropped because the frame was too long, s.
    pub skipped: f32,
}

impl StepClock {
    /// Makes the next frame start from the rest pose.
    pub fn reset(&mut self) {
        self.reset = true;
    }

    /// Makes the next frame a teleport, whatever the distance.
    pub fn teleport(&mut self) {
        self.teleports = true;
    }

    /// Returns the head's pose at the end of the last step, or `None` if the next frame starts from the rest pose.
    pub(crate) fn state(&self) -> Option<&Pose> {
        self.state.as_ref().filter(|_| !self.reset)
    }

    /// Returns the time since the last step, s, and the head's pose at its end.
    pub(crate) fn progress(&self) -> (f64, Pose) {
        (self.accumulator, self.state.unwrap_or(Pose::IDENTITY))
    }

    /// Sets what [`progress`](Self::progress) returns.
    pub(crate) fn set_progress(&mut self, rest: f64, head: Pose) {
        (self.accumulator, self.state) = (rest, Some(head));
    }

    /// Converts the stored pose to another space; `map` leads there.
    pub(crate) fn enter(&mut self, map: &Map) {
        self.state = self.state.map(|state| map.pose(&state));
    }

    /// Returns the number of steps of `step` seconds from the last step's end to the end of a frame of `dt` seconds.
    pub(crate) fn steps_to(&self, dt: f64, step: f64) -> f32 {
        ((self.accumulator + dt) / step).clamp(1.0, MAX_STEPS.into()) as f32
    }

    /// Whether the motion of the head from `at` to `head` within `steps` steps is a teleport.
    pub(crate) fn jumps(&self, at: &Pose, head: &Pose, steps: f32) -> bool {
        let distance = at.translation.distance(head.translation);
        let angle = at.rotation.angle_between(head.rotation);
        self.teleports
            || distance > self.teleport_distance * steps
            || angle > self.teleport_angle * steps
            || !distance.is_finite()
    }

    /// Returns the size of the motion from `at` to `head`, relative to the largest that one step takes without a
    /// teleport.
    pub(crate) fn relative_motion(&self, at: &Pose, head: &Pose) -> f32 {
        let distance = at.translation.distance(head.translation) / self.teleport_distance;
        distance.max(at.rotation.angle_between(head.rotation) / self.teleport_angle)
    }

    /// Returns the steps of `step` seconds each that are due in a frame, `dt` seconds after the last one, with the head
    /// now at `head`. A `dt` that is negative or NaN counts as 0. Time beyond [`MAX_STEPS`] steps is dropped and
    /// reported in [`Ticks::skipped`].
    pub fn tick(&mut self, dt: f32, step: f32, head: &Pose) -> Ticks {
        let full_step = |mode| Step { mode, begin: *head, end: *head, from: 0.0, to: 1.0 };
        let Some(at) = self.state.filter(|_| !self.reset) else {
            (self.reset, self.teleports) = (false, false);
            self.accumulator = 0.0;
            self.state = Some(*head);
            return Ticks { steps: vec![full_step(Mode::Reset)], alpha: 1.0, skipped: 0.0 };
        };
        let step = f64::from(step.clamp(1e-4, 0.1));
        let dt = if dt.is_finite() { f64::from(dt.max(0.0)) } else { 0.0 };
        let before = self.accumulator;
        // Tolerance for rounding: 1/60 s is not a sum of binary fractions.
        let due = ((before + dt) / step + 1e-4).floor();
        let count = due.min(f64::from(MAX_STEPS));
        let skipped = (due - count) * step;
        self.accumulator = (before + dt - due * step).max(0.0);
        // Time from the end of the last step to the frame's time.
        let lag = self.accumulator;
        let span = (before + dt - skipped).max(1e-9);
        let mut steps = Vec::with_capacity(count as usize);
        let jumps = self.jumps(&at, head, (span / step).max(1.0) as f32);
        self.teleports = false;
        if jumps {
            steps.push(Step { mode: Mode::Rigid, begin: at, end: *head, from: 0.0, to: 0.0 });
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
    fn step_count_is_independent_of_frame_rate() {
        for rate in [24.0f32, 30.0, 60.0, 90.0, 144.0, 1000.0] {
            let mut clock = StepClock::default();
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
    fn long_frames_drop_time_and_jumps_carry_hair() {
        let mut clock = StepClock::default();
        clock.tick(0.0, 1.0 / 60.0, &at(0.0));
        let ticks = clock.tick(2.0, 1.0 / 60.0, &at(0.2));
        assert_eq!(ticks.steps.len(), MAX_STEPS as usize);
        assert!((ticks.skipped - (2.0 - 8.0 / 60.0)).abs() < 0.02);
        assert_eq!(ticks.steps.last().map(|s| s.to > 0.99), Some(true));
        let ticks = clock.tick(1.0 / 60.0, 1.0 / 60.0, &at(5.0));
        assert_eq!(ticks.steps[0].mode, Mode::Rigid);
        assert_eq!(ticks.steps[0].end, at(5.0));
        assert!(clock.tick(f32::NAN, 1.0 / 60.0, &at(5.0)).steps.is_empty());
        clock.reset();
        assert_eq!(clock.tick(0.1, 1.0 / 60.0, &at(0.0)).steps[0].mode, Mode::Reset);
    }
}
