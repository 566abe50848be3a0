//! What holds hair besides its roots: ties, and a hand.

use super::Hair;
use crate::{
    Error, Result,
    groom::Groom,
    math::Ray,
    simulate::{Grab, Target, Tie, TieReport},
};

impl Hair {
    /// From the next frame on `ties` hold the hair, in place of those that did: bands, braids and pins, where they are in
    /// `groom`, the one that the hair was made from, at rest. See [`crate::simulate::ties`].
    ///
    /// # Errors
    /// [`Error::Parameter`] for a tie that makes no sense, [`crate::groom::Error::Unusable`] for one that holds nothing,
    /// for more than [`crate::simulate::ties::MAX_RINGS`] and for another groom; [`Error::Limit`].
    pub fn tie(&mut self, groom: &Groom, ties: &[Tie]) -> Result<TieReport> {
        if groom.guides.len() != self.guides.count as usize {
            return Err(Error::unusable("ties are those of the groom that the hair was made from"));
        }
        self.sleep.wake();
        self.simulation.tie(&self.context, &self.guides, &groom.guides, ties)
    }

    /// Grabs the lock that `ray` (from the eye through the cursor, in the camera's space: [`crate::Camera::ray`]) meets
    /// first: all of the hair that follows guide vertices within `radius` metres of there, or the nearest one. It
    /// holds it until [`release`](Self::release), until the head jumps or until the hair is
    /// [reset](Self::reset); a ray that meets no hair, or the head before it, holds nothing. See
    /// [`crate::simulate::grab`].
    ///
    /// # Errors
    /// [`Error::Parameter`] for a ray without a direction, and a radius that is not from 1 mm to 1 m.
    pub fn grab(&mut self, ray: &Ray, radius: f32) -> Result<()> {
        self.effects.grab.begin(ray, radius)
    }

    /// Where what is grabbed is to be at the next frame, in the space that it is drawn in. Nothing when nothing is.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what is not finite.
    pub fn drag_to(&mut self, target: &Target) -> Result<()> {
        self.effects.grab.drag(target)
    }

    /// Lets go of what is grabbed.
    pub fn release(&mut self) {
        self.effects.grab.end();
    }

    /// The hand: whether it holds, and what the GPU knows of it.
    pub fn grabbed(&self) -> &Grab {
        &self.effects.grab
    }
}
