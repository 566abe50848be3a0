//! Candidate frames of a file.

use super::{Axis, OrientationOverride};

/// A candidate frame: the file's axes that point up and forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub up: Axis,
    pub front: Axis,
}

impl Frame {
    /// Returns all 24 frames, the most common first.
    pub fn all() -> impl Iterator<Item = Self> {
        let pairs =
            Axis::ALL.into_iter().flat_map(|up| Axis::ALL.into_iter().map(move |front| Self { up, front }));
        pairs.filter(|f| f.up.vector().dot(f.front.vector()) == 0.0)
    }

    /// Returns the bonus for frames that common programs write.
    pub fn habit(self) -> f32 {
        match (self.up, self.front) {
            (Axis::Y, Axis::Z) => 0.3,
            (Axis::Z, Axis::NegY) => 0.2,
            (Axis::Z, Axis::Y) | (Axis::Y, Axis::NegZ) => 0.15,
            _ => 0.0,
        }
    }
}

impl OrientationOverride {
    pub(super) fn allows(&self, frame: Frame) -> bool {
        self.up.is_none_or(|up| up == frame.up) && self.front.is_none_or(|front| front == frame.front)
    }
}
