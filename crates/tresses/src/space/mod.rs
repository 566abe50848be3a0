//! Large worlds: where the space of a frame lies, and how hair goes along with it.
//!
//! A frame's poses are single precision, and so is the hair. Ten kilometres from an origin single precision has steps of
//! a millimetre, and a strand's weight stretches it by less. A [`Space`] is therefore given in double precision: the
//! place in the world of the space in which head and colliders are given. It may be the cell of a grid, the deck of a
//! ship, the character itself. Without one it is the world, and everything is to the bit as if there were no spaces.
//!
//! ```text
//! world (f64) ── Space ──► space of the poses ──► carrier ──► simulate, volume, wind        state of the hair
//!                    └──► space of the camera (HairFrame::drawn_in) ──► tessellate ─► … ─► draw
//! ```
//!
//! **The carrier** is the frame in which hair is simulated. Its origin goes with a point of the space near the hair, its
//! axes keep their direction in the world: a frame that does not turn but is accelerated. What is left of the space's
//! motion is then one acceleration that is the same everywhere, which goes into the uniform of gravity
//! (`carrier`). The space's turning remains a motion of the head, as any other, so that centrifugal, Coriolis' and
//! Euler's forces need no terms of their own. No kernel knows of spaces, but for the air: that of a cabin which turns has
//! another velocity at each place.
//!
//! **What moves is decided by what stays.** A head that stays in its space while the space moves is carried by it, be it
//! a metre or a kilometre per frame. A head that stays in the world, or nearly, while its place in its space jumps or the
//! space leaps as nothing moves that has mass, has been given in another space: coordinates are exchanged, and
//! nothing moves. A head that jumps in both is teleported ([`crate::clock`]).
//!
//! **Motion.** Where nobody gives the space's velocity, it is how far the carrier's origin came in the frame over its
//! time, half a frame late. Between frames it changes linearly with time, as poses do. A change by more than [`JOLT`]
//! from one frame to the next is a jump: no force, and if the frame after goes on like that, that is its velocity from
//! there on.
//!
//! **Far from the carrier.** When hair has strayed [`FAR`] metres, the carrier's origin moves by whole metres, and so do the
//! positions on the GPU (`shift.wesl`), to the bit.
//!
//! **Why not Coriolis' force in the step?** In axes that turn with the space, hair that rests in it would rest exactly. But
//! the step would pay for it at every vertex of all hair, and a space that turns by a large angle in a step, as a character's
//! own does, would need it implicit. **Why not offsets in double precision on the GPU?** WGSL has none, and what
//! a pair of floats would cost in every kernel is saved by one origin.
//!
//! **Known limits.** The fluid of a cabin that turns has the same wind at all its sides; uniform air is exact. Single
//! precision of a place counts where a caller computes it so: ten kilometres out, noise of 1 mm per frame is as strong as
//! gravity. Give [`Space::velocity`] then.

mod carrier;

pub(crate) use carrier::{Carried, Carrier, Field, Passage, Shift};

use crate::{Error, Pose, Result, math::map::Map};
use glam::{DQuat, DVec3};

/// A change of a space's velocity from one frame to the next by more than this, m/s, is a jump and not felt.
pub const JOLT: f64 = 20.0;
/// Hair is this far from where the carrier's origin was chosen for it, metres, before that moves.
pub const FAR: f32 = 2.0;
/// A space that moves faster than this, m/s, takes its air along, whatever it says: the fastest wind that there is.
pub const FASTEST: f64 = 500.0;

/// A space: where in the world that lies in which poses are given, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// Where its origin is in the world, metres.
    pub at: DVec3,
    /// How it is turned, a unit quaternion.
    pub rotation: DQuat,
    /// How it moves, where that is known; else it is measured from frame to frame.
    pub velocity: Option<Velocity>,
    /// Whether the air goes with it, as in a cabin: then the wind is relative to it and in its axes. Else it is the
    /// world's, and who moves through it feels that.
    pub carries_air: bool,
}

/// The motion of a rigid space, in the axes of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Of its origin, m/s.
    pub linear: DVec3,
    /// About it, radians per second.
    pub angular: DVec3,
}

impl Default for Space {
    fn default() -> Self {
        Self::WORLD
    }
}

impl Space {
    /// The world itself.
    pub const WORLD: Self =
        Self { at: DVec3::ZERO, rotation: DQuat::IDENTITY, velocity: None, carries_air: false };

    /// A space with the world's axes around `at`, metres.
    pub const fn at(at: DVec3) -> Self {
        Self { at, ..Self::WORLD }
    }

    /// A pose that is given in `other`, as it is in this space: what lights, bodies and hair need that are
    /// seen together. The difference of the places is taken in double precision.
    pub fn pose_from(&self, other: &Self, pose: &Pose) -> Pose {
        self.from(other).pose(pose)
    }

    /// From `other` to this space.
    pub(crate) fn from(&self, other: &Self) -> Map {
        if self.is_where(other) {
            return Map::IDENTITY;
        }
        let back = self.rotation.inverse();
        Map {
            rotation: if self.rotation == other.rotation { DQuat::IDENTITY } else { back * other.rotation },
            translation: back * (other.at - self.at),
        }
    }

    /// Whether it lies where `other` does.
    pub(crate) fn is_where(&self, other: &Self) -> bool {
        self.at == other.at && self.rotation == other.rotation
    }

    /// Checks that it is somewhere.
    ///
    /// # Errors
    /// [`Error::Parameter`] for places and motions that are not finite, and rotations that are none.
    pub fn check(&self) -> Result<()> {
        let moves = self.velocity.is_none_or(|v| v.linear.is_finite() && v.angular.is_finite());
        if self.at.is_finite() && moves && (self.rotation.length_squared() - 1.0).abs() < 1e-4 {
            return Ok(());
        }
        Err(Error::Parameter {
            name: "a space",
            value: format!("{self:?}"),
            range: "finite, with a unit rotation",
        })
    }

    /// The same with a rotation of length 1.
    pub(crate) fn normalized(&self) -> Self {
        let exact = (self.rotation.length_squared() - 1.0).abs() < 4.0 * f64::EPSILON;
        Self { rotation: if exact { self.rotation } else { self.rotation.normalize() }, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};

    #[test]
    fn a_pose_is_seen_from_elsewhere() {
        let pose = Pose { rotation: Quat::from_rotation_z(0.3), translation: Vec3::new(0.1, 1.5, -0.2) };
        let far = DVec3::new(1e7 + 0.25, -3.0, 1e6);
        let (here, eye) = (Space::at(far), Space::at(far - DVec3::new(2.0, 0.5, -1.0)));
        // To the bit, where places are: the sum of floats is what they are in single precision.
        let seen = eye.pose_from(&here, &pose);
        assert_eq!(seen, Pose { translation: pose.translation + Vec3::new(2.0, 0.5, -1.0), ..pose });
        assert_eq!(here.pose_from(&here, &pose), pose);
        // Folded into single precision it is somewhere else.
        let folded = pose.translation + far.as_vec3() - eye.at.as_vec3();
        assert!(folded.distance(seen.translation) > 0.1);
        let turned = Space { rotation: DQuat::from_rotation_y(1.0), ..here };
        let back = here.pose_from(&turned, &turned.pose_from(&here, &pose));
        assert!(back.translation.distance(pose.translation) < 1e-6);
        assert!(back.rotation.angle_between(pose.rotation) < 1e-3);
        let moved = turned.pose_from(&here, &pose).translation;
        assert!(moved.distance(Quat::from_rotation_y(-1.0) * pose.translation) < 1e-6);
    }

    #[test]
    fn what_is_nowhere_is_refused() {
        Space::WORLD.check().unwrap();
        let velocity = Some(Velocity { linear: DVec3::NAN, ..Default::default() });
        for wrong in [
            Space::at(DVec3::splat(f64::INFINITY)),
            Space { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..Space::WORLD },
            Space { velocity, ..Space::WORLD },
        ] {
            assert!(wrong.check().unwrap_err().to_string().contains("a space"));
        }
    }
}
