//! The motion of a character in one frame.

use super::{Character, Fringe, colliding, facial};
use crate::{Pose, Result, collide::ColliderPoses, frame::Recorder, hair::HairFrame, light::Sphere};

impl Character {
    /// Computes how the colliders of the body deform with its skin. Otherwise the first frame that bends the body does
    /// it, which takes a second for a large mesh.
    ///
    /// # Errors
    /// [`crate::Error::Colliders`] and [`crate::Error::Limit`] when the fields exceed the size of a texture.
    pub fn prepare_to_bend(&mut self) -> Result<()> {
        let (Some(rigged), Some(body)) = (&mut self.rigged, &self.body) else { return Ok(()) };
        let hair = colliding(&mut self.hair, &mut self.face);
        rigged.deform(body, self.asset.field.is_some(), &self.obstacles.part_fields(), hair)
    }

    /// Computes the poses at the end of a frame of `dt` seconds: the first part of a frame.
    pub(super) fn find_pose(&mut self, dt: f32) -> Result<()> {
        self.time += f64::from(dt);
        self.parts.clear();
        self.head = self.gesture.rigid();
        // A mesh that the host deforms already contains the turn of the head.
        self.pose = if self.hair.roots.is_some() { self.gesture.body } else { self.head };
        if let (Some(rigged), Some(body)) = (&mut self.rigged, &mut self.body) {
            let pose = rigged.pose(self.time, &self.gesture, body)?;
            self.pose = self.gesture.body;
            self.head = self.pose.after(&pose.head);
            self.parts.extend(pose.parts.iter().map(|part| self.pose.after(part)));
            if rigged.bends(&pose) {
                let hair = colliding(&mut self.hair, &mut self.face);
                rigged.deform(body, self.asset.field.is_some(), &self.obstacles.part_fields(), hair)?;
            }
            for hair in colliding(&mut self.hair, &mut self.face) {
                if let Some(deformation) = &mut hair.colliders.deformation {
                    deformation.poses.clear();
                    deformation.poses.extend(rigged.deforming(&pose));
                }
            }
        }
        let (pose, is_still) = (self.pose, self.rigged.as_ref().is_some_and(|rigged| rigged.is_still));
        for hair in self.grooms_mut() {
            hair.motion.skin_is_still = is_still;
            if let Some(roots) = &mut hair.roots {
                roots.pose = pose;
            }
        }
        let drawn = self.drawn(&pose);
        for body in self.body.iter_mut().chain(&mut self.props) {
            body.pose = drawn;
        }
        Ok(())
    }

    /// Converts `pose` to the space that the character is drawn in.
    pub(super) fn drawn(&self, pose: &Pose) -> Pose {
        match self.drawn_in {
            Some(_) => HairFrame { space: self.space, drawn_in: self.drawn_in, ..HairFrame::default() }
                .map_to_drawn()
                .pose(pose),
            None => *pose,
        }
    }

    /// Records the motion of all grooms: the last part of a frame.
    pub(super) fn advance(&mut self, recorder: &mut Recorder<'_>, dt: f32) -> Result<()> {
        let colliders = self.obstacles.poses(&self.parts);
        let nowhere = ColliderPoses::default();
        let (physics, head, space, drawn_in) = (self.physics, self.head, self.space, self.drawn_in);
        let frame = HairFrame { dt, head, colliders: &colliders, simulation: &physics, space, drawn_in };
        recorder.advance(&mut self.hair, &frame)?;
        for Fringe { hair, hangs } in &mut self.face {
            hair.lod.options = self.hair.lod.options;
            hair.set.reuse_fibers(&self.hair.set);
            let simulation = &facial::physics(&physics, *hangs);
            let colliders = if *hangs { &colliders } else { &nowhere };
            recorder.advance(hair, &HairFrame { simulation, colliders, ..frame })?;
        }
        Ok(())
    }

    /// Returns the head's pose in the space that the character is drawn in.
    pub(super) fn head_drawn(&self) -> Pose {
        self.drawn(&self.head)
    }

    /// Returns [`focus`](Character::focus) in the space that the character is drawn in.
    pub(super) fn focus_drawn(&self) -> Sphere {
        let focus = self.focus();
        let center = Pose { translation: focus.center, ..Pose::IDENTITY };
        Sphere { center: self.drawn(&center).translation, ..focus }
    }
}
