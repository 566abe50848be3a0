//! The inputs of one groom's frame.

use crate::{Pose, collide::ColliderPoses, math::map::Map, simulate::SimulationParams, space::Space};
use std::sync::LazyLock;

/// What the motion of a groom depends on besides the hair itself.
#[derive(Clone, Copy, Debug)]
pub struct HairFrame<'a> {
    /// Time since the last frame, seconds.
    pub dt: f32,
    /// Where the head is now. Roots follow it rigidly.
    pub head: Pose,
    /// Where the colliders are now.
    pub colliders: &'a ColliderPoses,
    /// The physics. Gravity and wind have the axes of the world.
    pub simulation: &'a SimulationParams,
    /// Where in the world the space is in which `head`, `colliders` and [roots](crate::roots::Roots::pose) are given, and
    /// how it moves ([`crate::space`]).
    pub space: Space,
    /// The space in which hair is drawn, that of cameras, lights and bodies; `None` for `space`. All hair of one view is
    /// drawn in the same.
    pub drawn_in: Option<Space>,
}

impl Default for HairFrame<'_> {
    /// A head at rest at the world's origin, without obstacles but its own, with the usual physics; no time passes.
    fn default() -> Self {
        static COLLIDERS: ColliderPoses = ColliderPoses { head: None, colliders: Vec::new() };
        static PHYSICS: LazyLock<SimulationParams> = LazyLock::new(SimulationParams::default);
        Self {
            dt: 0.0,
            head: Pose::IDENTITY,
            colliders: &COLLIDERS,
            simulation: &PHYSICS,
            space: Space::WORLD,
            drawn_in: None,
        }
    }
}

impl HairFrame<'_> {
    /// The space in which it is drawn.
    pub(crate) fn seen(&self) -> Space {
        self.drawn_in.unwrap_or(self.space).normalized()
    }

    /// From the space of its poses to the one in which it is drawn.
    pub(crate) fn way_to_view(&self) -> Map {
        self.seen().from(&self.space.normalized())
    }
}
