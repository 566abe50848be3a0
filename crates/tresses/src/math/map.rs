//! From one space to another, in double precision.

use super::{Ray, pose::Pose};
use glam::{DMat4, DQuat, DVec3, Vec3};

/// A rotation and a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Map {
    /// Unit quaternion; exactly the identity where nothing turns.
    pub rotation: DQuat,
    /// Metres.
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

    /// First `other`, then this.
    pub fn after(&self, other: &Self) -> Self {
        let turns = self.rotation != DQuat::IDENTITY && other.rotation != DQuat::IDENTITY;
        let product = self.rotation * other.rotation;
        Self {
            rotation: if turns { product.normalize() } else { product },
            translation: self.point(other.translation),
        }
    }

    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// A pose there; to the bit the same where nothing turns and the sum can be represented.
    pub fn pose(&self, pose: &Pose) -> Pose {
        let translation = self.point(pose.translation.as_dvec3()).as_vec3();
        if self.rotation == DQuat::IDENTITY {
            return Pose { rotation: pose.rotation, translation };
        }
        Pose { rotation: (self.rotation * pose.rotation.as_dquat()).normalize().as_quat(), translation }
    }

    /// A ray there.
    pub fn ray(&self, ray: &Ray) -> Ray {
        Ray { origin: self.at(ray.origin), direction: self.turned(ray.direction) }
    }

    /// A place there.
    pub fn at(&self, p: Vec3) -> Vec3 {
        self.point(p.as_dvec3()).as_vec3()
    }

    /// A direction there.
    pub fn turned(&self, v: Vec3) -> Vec3 {
        if self.rotation == DQuat::IDENTITY { v } else { (self.rotation * v.as_dvec3()).as_vec3() }
    }

    /// As a matrix.
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_rotation_translation(self.rotation, self.translation)
    }

    /// As a pose.
    pub fn as_pose(&self) -> Pose {
        self.pose(&Pose::IDENTITY)
    }
}
