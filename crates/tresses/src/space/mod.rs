//! Large worlds: where a frame's coordinate system lies in the world, and how hair moves with it.
//!
//! A frame's poses are in single precision, and so is the hair. Ten kilometers from an origin, single precision
//! resolves only a millimeter, while a strand's own weight stretches it by less. A [`Space`] therefore gives the place
//! in the world of the coordinate system of head and colliders in double precision. It may be the cell of a grid, the
//! deck of a ship, or the character itself. Without one it is the world, and results are bit-identical to a simulation
//! without spaces.
//!
//! ```text
//! world (f64) ── Space ──► space of the poses ──► carrier ──► simulate, volume, wind        state of the hair
//!                    └──► space of the camera (HairFrame::drawn_in) ──► tessellate ─► … ─► draw
//! ```
//!
//! **The carrier** is the frame of reference in which hair is simulated. Its origin moves with a point of the space
//! near the hair. Its axes keep their direction in the world, so it accelerates but does not rotate. The space's
//! translation then reduces to one uniform acceleration, which is added to gravity (`carrier`). The space's rotation
//! appears as a motion of the head, so centrifugal, Coriolis and Euler forces need no extra terms. Kernels know nothing
//! of spaces, with one exception: the air of a rotating cabin has a different velocity at each place.
//!
//! **Change of coordinates or motion?** The quantity that stays constant decides. A head that stays in its space while
//! the space moves is carried by the space, by a meter or a kilometer per frame. If the head stays in the world
//! (nearly), while its pose in the space jumps or the space moves faster than anything with mass can, then only the
//! coordinates have changed, and nothing moves. A head that jumps in both is teleported ([`crate::clock`]).
//!
//! **Velocity.** Unless the caller gives the space's velocity, it is measured as the displacement of the carrier's
//! origin over the frame's time, which lags by half a frame. Between frames it is interpolated linearly, like poses. A
//! change of more than [`JOLT`] from one frame to the next counts as a jump and exerts no force. If the next frame
//! confirms the new velocity, it is used from then on.
//!
//! **Far from the carrier.** When hair is [`FAR`] meters from the carrier's origin, the origin moves by whole meters.
//! The positions on the GPU are shifted by the same amount (`shift.wesl`), without rounding error.
//!
//! **Why not a Coriolis force in the step?** In axes that rotate with the space, hair at rest in it would stay exactly
//! at rest. But every vertex of all hair would pay for it, and a space that turns by a large angle per step, such as a
//! character's own, would need an implicit treatment. **Why not double-precision offsets on the GPU?** WGSL has no
//! doubles, and one moving origin avoids the cost of float pairs in every kernel.
//!
//! **Known limits.** The fluid of a rotating cabin has the same wind on all its sides; uniform air is exact. If the
//! caller computes a space's place in single precision, its rounding is felt: ten kilometers out, 1 mm of noise per
//! frame is as strong as gravity. Set [`Space::velocity`] in that case.

mod carrier;

pub(crate) use carrier::{Carrier, CarrierFrame, Field, Passage, Shift};

use crate::{Error, Pose, Result, math::map::Map};
use glam::{DQuat, DVec3};

/// Maximum change of a space's velocity from one frame to the next, m/s. A larger change is a jump and exerts no force.
pub const JOLT: f64 = 20.0;
/// Offset of the hair from its rest position in the carrier, per axis, above which the carrier's origin moves, meters.
pub const FAR: f32 = 2.0;
/// Speed above which a space always carries its air along, m/s: the fastest wind.
pub const FASTEST: f64 = 500.0;

/// A coordinate system in the world in which poses are given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// Position of its origin in the world, meters.
    pub at: DVec3,
    /// Orientation in the world, a unit quaternion.
    pub rotation: DQuat,
    /// Velocity, if known; otherwise it is measured from frame to frame.
    pub velocity: Option<Velocity>,
    /// Whether the air moves with the space, as in a cabin. If so, the wind is relative to the space and in its axes.
    /// Otherwise the air is the world's, and motion through it is felt as wind.
    pub moves_air: bool,
}

/// The motion of a rigid space, in the axes of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Velocity of the origin, m/s.
    pub linear: DVec3,
    /// Angular velocity, rad/s.
    pub angular: DVec3,
}

impl Default for Space {
    fn default() -> Self {
        Self::WORLD
    }
}

impl Space {
    /// The world.
    pub const WORLD: Self =
        Self { at: DVec3::ZERO, rotation: DQuat::IDENTITY, velocity: None, moves_air: false };

    /// Creates a space at `at` (meters) with the world's axes.
    pub const fn at(at: DVec3) -> Self {
        Self { at, ..Self::WORLD }
    }

    /// Converts a pose from `other` to this space, for lights, bodies and hair that are seen together. Places are
    /// subtracted in double precision.
    pub fn pose_from(&self, other: &Self, pose: &Pose) -> Pose {
        self.from(other).pose(pose)
    }

    /// Returns the map from `other` to this space.
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

    /// Whether both spaces have the same place and orientation.
    pub(crate) fn is_where(&self, other: &Self) -> bool {
        self.at == other.at && self.rotation == other.rotation
    }

    /// Checks that all values are valid.
    ///
    /// # Errors
    /// [`Error::Parameter`] for values that are not finite, and for a rotation that is not a unit quaternion.
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

    /// Returns this space with an exactly normalized rotation.
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
    fn pose_from_is_exact_far_from_origin() {
        let pose = Pose { rotation: Quat::from_rotation_z(0.3), translation: Vec3::new(0.1, 1.5, -0.2) };
        let far = DVec3::new(1e7 + 0.25, -3.0, 1e6);
        let (here, eye) = (Space::at(far), Space::at(far - DVec3::new(2.0, 0.5, -1.0)));
        // Bit-identical, since the difference of the places can be represented in single precision.
        let seen = eye.pose_from(&here, &pose);
        assert_eq!(seen, Pose { translation: pose.translation + Vec3::new(2.0, 0.5, -1.0), ..pose });
        assert_eq!(here.pose_from(&here, &pose), pose);
        // With places folded into single precision, the result is off.
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
    fn invalid_spaces_are_rejected() {
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
