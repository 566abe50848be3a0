//! Candidate axes of a file.

use super::{Axis, Choice};

/// A candidate: the file's axes that point up and forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub up: Axis,
    pub front: Axis,
}

impl Frame {
    /// All 24, the usual ones first.
    pub fn all() -> impl Iterator<Item = Self> {
        let pairs =
            Axis::ALL.into_iter().flat_map(|up| Axis::ALL.into_iter().map(move |front| Self { up, front }));
        pairs.filter(|f| f.up.vector().dot(f.front.vector()) == 0.0)
    }

    /// How common it is among programs.
    pub fn habit(self) -> f32 {
        match (self.up, self.front) {
            (Axis::Y, Axis::Z) => 0.3,
            (Axis::Z, Axis::NegY) => 0.2,
            (Axis::Z, Axis::Y) | (Axis::Y, Axis::NegZ) => 0.15,
            _ => 0.0,
        }
    }
}

impl Choice {
    pub(super) fn allows(&self, frame: Frame) -> bool {
        self.up.is_none_or(|up| up == frame.up) && self.front.is_none_or(|front| front == frame.front)
    }
}
