//! Constraints on hair besides its roots, and hands on it: ties, grabs and brushes.

use super::Hair;
use crate::{
    Result,
    groom::tie::Tie,
    math::Ray,
    simulate::{Grab, GrabTarget, MotionBrush, TieAsset, TieReport},
};

impl Hair {
    /// Replaces the ties that hold the hair from the next frame on: bands, braids and pins. Their positions refer to
    /// the resting groom.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for an invalid tie, [`crate::groom::Error::Unusable`] for a tie
    /// that holds nothing and for more than `MAX_RINGS` rings;
    /// [`Error::Limit`](crate::Error::Limit).
    pub fn tie(&mut self, ties: &[Tie]) -> Result<TieReport> {
        let context = &self.asset.context;
        let ties = TieAsset::new(context, &self.asset.rest, ties)?;
        self.sleep.wake();
        self.simulation.tie(context, &self.guides, ties.as_ref())?;
        Ok(ties.map(|ties| ties.report()).unwrap_or_default())
    }

    /// Takes over the ties of `other`, which has the same asset.
    pub(crate) fn tie_as(&mut self, other: &Self) -> Result<()> {
        let ties = other.simulation.ties().map(|ties| &ties.asset);
        self.simulation.tie(&self.asset.context, &self.guides, ties)
    }

    /// Grabs the lock that `ray` hits first. The ray starts at the eye, passes through the cursor and is in the
    /// camera's space ([`crate::Camera::ray`]). Grabs all hair that follows guide vertices within `radius` meters of
    /// the hit, or the nearest vertex. The grab lasts until [`release`](Self::release), until the head jumps or until
    /// [`reset`](Self::reset). A ray that hits no hair, or the head first, grabs nothing.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a ray without a direction, and for a radius outside 1 mm to 1
    /// m.
    pub fn grab(&mut self, ray: &Ray, radius: f32) -> Result<()> {
        self.effects.grab.begin(ray, radius)
    }

    /// Sets the target of the grabbed lock for the next frame, in the space in which the hair is drawn. Does nothing
    /// without a grab.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a target that is not finite.
    pub fn drag_to(&mut self, target: &GrabTarget) -> Result<()> {
        self.effects.grab.drag(target)
    }

    /// Puts a brush on the hair that `ray` hits first, or moves it there from its last place. It acts in every frame
    /// until [`release`](Self::release), until the head jumps or until [`reset`](Self::reset). The ray is as in
    /// [`grab`](Self::grab); where it hits no hair, the brush keeps its depth.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a ray without a direction, and for values out of range.
    pub fn brush(&mut self, brush: &MotionBrush, ray: &Ray) -> Result<()> {
        self.effects.grab.brush(brush, ray)
    }

    /// Releases the grabbed lock, or takes the brush away.
    pub fn release(&mut self) {
        self.effects.grab.end();
    }

    /// Returns the grab or brush: whether it is active, and its GPU state.
    pub fn grabbed(&self) -> &Grab {
        &self.effects.grab
    }
}
