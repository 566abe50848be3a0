//! The motion state of one groom on the CPU: its clock, and the spaces in which it is simulated and drawn.

use crate::{
    Pose,
    clock::StepClock,
    simulate::Shifting,
    space::{Carrier, Passage, Space},
};

/// Motion state kept on the CPU.
#[derive(Debug)]
pub(crate) struct Motion {
    pub clock: StepClock,
    /// The frame of reference in which the hair is simulated.
    pub carrier: Carrier,
    /// Transform from the space of the poses to the carrier during this frame.
    pub passage: Passage,
    /// Moves the GPU state to another origin once the hair is far from the carrier's; then whether this frame does so.
    pub shifting: Option<Shifting>,
    pub shifts: bool,
    /// The space in which the hair is drawn, and the transform there from simulation space.
    pub drawn_in: Space,
    pub to_drawn: Pose,
    /// Poses of the head before and after the last step, and the blend between them.
    pub states: (Pose, Pose, f32),
    /// Length of the last step, s.
    pub span: f32,
    /// Pose of the head as drawn in the current frame.
    pub head: Pose,
    /// Whether the last frame carried or reset the hair.
    pub has_jumped: bool,
    /// Whether the skin below the hair has not changed since the last frame.
    pub skin_is_still: bool,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            clock: StepClock::default(),
            carrier: Carrier::default(),
            passage: Passage::default(),
            shifting: None,
            shifts: false,
            drawn_in: Space::WORLD,
            to_drawn: Pose::IDENTITY,
            states: (Pose::IDENTITY, Pose::IDENTITY, 1.0),
            span: 0.0,
            head: Pose::IDENTITY,
            has_jumped: false,
            skin_is_still: false,
        }
    }
}
