//! Fixed steps from an accumulator.

use super::{MAX_STEPS, SimulationParams, Step, params::Mode};
use crate::{Pose, Result};

/// When the next step is due, and where the head was.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Time since the last step, seconds.
    due: f32,
    /// 0 draws the state before the last step, 1 that after it.
    blend: f32,
    /// The head at the end of the last frame.
    head: Pose,
    previous: Pose,
    current: Pose,
    reset: bool,
}

impl Clock {
    /// A clock for hair that rests on a head at `pose`.
    pub fn new(pose: Pose) -> Self {
        Self { due: 0.0, blend: 1.0, head: pose, previous: pose, current: pose, reset: true }
    }

    /// Rest on a head at `pose` from the next tick on.
    pub fn reset(&mut self, pose: Pose) {
        *self = Self::new(pose);
    }

    /// The steps that are due after `dt` seconds during which the head moved to `head`.
    pub fn tick(&mut self, dt: f32, head: Pose, params: &SimulationParams) -> Result<Vec<Step>> {
        params.check()?;
        if self.reset {
            self.reset = false;
            *self = Self { reset: false, ..Self::new(head) };
            return Ok(vec![Step { mode: Mode::Reset, begin: head, end: head, from: 0.0, to: 1.0 }]);
        }
        let dt = if dt.is_finite() { dt.clamp(0.0, params.step * MAX_STEPS as f32) } else { 0.0 };
        let before = self.due;
        self.due += dt;
        let mut steps = Vec::new();
        let mut at = -before;
        while self.due >= params.step * 0.9999 {
            self.due -= params.step;
            let end_at = at + params.step;
            let to = if dt > 0.0 { (end_at / dt).clamp(0.0, 1.0) } else { 1.0 };
            let end = self.head.lerp(&head, to);
            let from = steps.last().map_or(0.0, |s: &Step| s.to);
            steps.push(Step { mode: Mode::Step, begin: self.current, end, from, to });
            self.previous = self.current;
            self.current = end;
            at = end_at;
        }
        self.due = self.due.max(0.0);
        self.blend = (self.due / params.step).min(1.0);
        self.head = head;
        Ok(steps)
    }

    /// The head's poses of the states before and after the last step, and the blend between them.
    pub fn states(&self) -> (Pose, Pose, f32) {
        (self.previous, self.current, self.blend)
    }
}
