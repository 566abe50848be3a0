//! The pose that a host sets for a character, in addition to its animation.

use crate::Pose;
use std::sync::Arc;

/// A pose set by the host: pose of the body, turn of the head, blend shape weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gesture {
    /// Pose of the body, from groom space to the world.
    pub body: Pose,
    /// Turn of the head on the neck, relative to the body.
    pub head: Pose,
    /// Weights of blend shapes by name.
    pub shapes: Vec<(Arc<str>, f32)>,
}

impl From<Pose> for Gesture {
    /// A body at that pose with the head straight.
    fn from(body: Pose) -> Self {
        Self { body, ..Self::default() }
    }
}

impl Gesture {
    /// Returns the pose of a rigid body, which turns with its head.
    pub fn rigid(&self) -> Pose {
        self.body.after(&self.head)
    }

    /// Interpolates from this gesture (`t` = 0) to `other` (`t` = 1).
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        let names = self.shapes.iter().chain(&other.shapes).map(|(name, _)| name);
        let mut shapes: Vec<(Arc<str>, f32)> = Vec::new();
        for name in names {
            if shapes.iter().all(|(other, _)| other != name) {
                let (from, to) = (self.shape(name), other.shape(name));
                shapes.push((name.clone(), from + (to - from) * t));
            }
        }
        Self { body: self.body.lerp(&other.body, t), head: self.head.lerp(&other.head, t), shapes }
    }

    /// Returns the weight of a blend shape.
    pub fn shape(&self, name: &str) -> f32 {
        self.shapes.iter().find(|(other, _)| **other == *name).map_or(0.0, |(_, weight)| *weight)
    }
}
