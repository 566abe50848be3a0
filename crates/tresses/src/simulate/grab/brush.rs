//! Brushes on moving hair.
//!
//! **Place.** The brush lies on the hair under its ray, found in each frame by the kernels of a grab; where there is
//! none, it keeps its depth. It reaches hair up to three radii before it and 1.5 radii, at most 5 cm, behind it.
//!
//! **Force.** `sweep` pulls guide vertices towards a velocity, by a rate that the step treats implicitly, within the
//! bounds of a grab. The comb's pull acts across the hair, and to a fifth along it, so the hair slides through.

use crate::{Error, Result};
use glam::Vec3;

/// Effect of a [`MotionBrush`] on the hair under it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
#[non_exhaustive]
pub enum BrushEffect {
    /// Drags hair along. It slides through the brush.
    #[default]
    Comb = 1,
    /// Raises hair, away from the skin.
    Puff = 2,
    /// Drags hair along and lays it on the skin.
    Lay = 3,
    /// Pulls hair towards the line of the stroke.
    Pinch = 4,
    /// Pushes hair away from the line of the stroke.
    Spread = 5,
    /// Blows air from the eye, along the skin where it meets it.
    Blow = 6,
    /// Draws in air towards the eye.
    Draw = 7,
}

/// A brush that pushes moving hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionBrush {
    /// Effect on the hair.
    pub effect: BrushEffect,
    /// Radius, meters, 0.001 to 1.
    pub radius: f32,
    /// Share of the full effect, 0 to 1.
    pub strength: f32,
    /// Where along the hair it acts: 0 everywhere, 1 more towards the tip, -1 more towards the root.
    pub root_tip: f32,
    /// Plane at which the brush is mirrored, in the space of the ray: a point and the unit normal.
    pub mirror: Option<(Vec3, Vec3)>,
}

impl Default for MotionBrush {
    fn default() -> Self {
        Self { effect: BrushEffect::Comb, radius: 0.03, strength: 0.5, root_tip: 0.0, mirror: None }
    }
}

impl MotionBrush {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<()> {
        Error::unless_within("brush.radius", self.radius, 1e-3, 1.0, "from 0.001 to 1 m")?;
        Error::unless_within("brush.strength", self.strength, 0.0, 1.0, "from 0 to 1")?;
        Error::unless_within("brush.root_tip", self.root_tip, -1.0, 1.0, "from -1 to 1")?;
        match self.mirror {
            Some((at, normal)) if !(at.is_finite() && normal.is_normalized()) => Err(Error::Parameter {
                name: "brush.mirror",
                value: format!("{at}, {normal}"),
                range: "a point and a unit normal",
            }),
            _ => Ok(()),
        }
    }
}
