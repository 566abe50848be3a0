//! The motion of one groom: its clock, and the frames that it is simulated and drawn in.

use crate::{
    Pose,
    clock::Clock,
    simulate::Shifting,
    space::{Carrier, Passage, Space},
};

/// The state of motion that the CPU keeps.
#[derive(Debug)]
pub(crate) struct Motion {
    pub clock: Clock,
    /// The frame that goes along with the space of the poses.
    pub carrier: Carrier,
    /// From that space to the carrier, in this frame.
    pub passage: Passage,
    /// Moves the state to another origin, once the hair has strayed, and whether this frame does.
    pub shifting: Option<Shifting>,
    pub shifts: bool,
    /// The space that it is drawn in, and the way there from where it is simulated.
    pub drawn_in: Space,
    pub to_drawn: Pose,
    /// Poses of the head before and after the last step, and the blend between them.
    pub states: (Pose, Pose, f32),
    /// Length of the last step, s.
    pub span: f32,
    /// The head as it is drawn in the frame that is recorded.
    pub head: Pose,
    /// Whether the last frame put the hair somewhere else.
    pub moved_away: bool,
    /// Whether the next frame carries it along, wherever the head goes.
    pub teleports: bool,
    /// Whether the skin that it is on is as in the last frame.
    pub skin_is_still: bool,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            clock: Clock::default(),
            carrier: Carrier::default(),
            passage: Passage::default(),
            shifting: None,
            shifts: false,
            drawn_in: Space::WORLD,
            to_drawn: Pose::IDENTITY,
            states: (Pose::IDENTITY, Pose::IDENTITY, 1.0),
            span: 0.0,
            head: Pose::IDENTITY,
            moved_away: false,
            teleports: false,
            skin_is_still: false,
        }
    }
}
