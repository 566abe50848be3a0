//! Rigid transforms between spaces, in double precision.

use super::{Ray, pose::Pose};
use glam::{DMat4, DQuat, DVec3, Vec3};

/// A rotation followed by a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Map {
    /// Unit quaternion; exactly the identity if there is no rotation.
    pub rotation: DQuat,
    /// Translation, meters.
    pub translation: DVec3,
}

impl Default for Map {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Map {
    pub const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// Returns the map that applies `other` first, then this one.
    pub fn after(&self, other: &Self) -> Self {
        let both_rotate = self.rotation != DQuat::IDENTITY && other.rotation != DQuat::IDENTITY;
        let product = self.rotation * other.rotation;
        Self {
            rotation: if both_rotate { product.normalize() } else { product },
            translation: self.point(other.translation),
        }
    }

    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// Transforms a pose. Bit-identical without rotation, if the sum can be represented.
    pub fn pose(&self, pose: &Pose) -> Pose {
        let translation = self.point(pose.translation.as_dvec3()).as_vec3();
        if self.rotation == DQuat::IDENTITY {
            return Pose { rotation: pose.rotation, translation };
        }
        Pose { rotation: (self.rotation * pose.rotation.as_dquat()).normalize().as_quat(), translation }
    }

    /// Transforms a ray.
    pub fn ray(&self, ray: &Ray) -> Ray {
        Ray { origin: self.at(ray.origin), direction: self.vector(ray.direction) }
    }

    /// Transforms a point.
    pub fn at(&self, p: Vec3) -> Vec3 {
        self.point(p.as_dvec3()).as_vec3()
    }

    /// Transforms a direction.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        if self.rotation == DQuat::IDENTITY { v } else { (self.rotation * v.as_dvec3()).as_vec3() }
    }

    /// Returns the map as a matrix.
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_rotation_translation(self.rotation, self.translation)
    }

    /// Returns the map as a pose in single precision.
    pub(crate) fn as_pose(&self) -> Pose {
        self.pose(&Pose::IDENTITY)
    }
}
