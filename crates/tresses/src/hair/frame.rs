//! The inputs of one groom's frame.

use crate::{Pose, collide::ColliderPoses, math::map::Map, simulate::SimulationParams, space::Space};
use std::sync::LazyLock;

/// Inputs that move a groom in one frame.
#[derive(Clone, Copy, Debug)]
pub struct HairFrame<'a> {
    /// Time since the last frame, seconds.
    pub dt: f32,
    /// Pose of the head. Roots follow it rigidly.
    pub head: Pose,
    /// Poses of the colliders.
    pub colliders: &'a ColliderPoses,
    /// Physics. Gravity and wind are in the axes of the world.
    pub simulation: &'a SimulationParams,
    /// Space of `head`, `colliders` and roots, with its place and motion in the world
    ///.
    pub space: Space,
    /// Space of cameras, lights and bodies, in which the hair is drawn; `None` for `space`. All hair of one view must
    /// be drawn in the same space.
    pub drawn_in: Option<Space>,
}

impl Default for HairFrame<'_> {
    /// A head at rest at the world's origin, with default physics, no time step and no colliders besides its own field.
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
    /// Returns the space in which the hair is drawn.
    pub(crate) fn drawn_space(&self) -> Space {
        self.drawn_in.unwrap_or(self.space).normalized()
    }

    /// Returns the map from the space of the poses to the space in which the hair is drawn.
    pub(crate) fn map_to_drawn(&self) -> Map {
        self.drawn_space().from(&self.space.normalized())
    }
}
