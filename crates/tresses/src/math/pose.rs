//! Rigid poses of heads and colliders.

use crate::groom::rotation::nearest_rotation;
use glam::{DVec3, Mat4, Quat, Vec3};

/// A rotation followed by a translation, from groom space to the world, in meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Unit quaternion.
    pub rotation: Quat,
    /// Translation, meters.
    pub translation: Vec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    /// No rotation and no translation.
    pub const IDENTITY: Self = Self { rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// Returns a rotation about a fixed point (meters), for example a neck joint.
    pub fn about(pivot: Vec3, rotation: Quat) -> Self {
        Self { rotation, translation: pivot - rotation * pivot }
    }

    /// Transforms a point from groom space to the world.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.rotation * p + self.translation
    }

    /// Returns the pose that applies `other` first, then `self`: it maps `p` to `self.point(other.point(p))`.
    pub fn after(&self, other: &Self) -> Self {
        Self {
            rotation: (self.rotation * other.rotation).normalize(),
            translation: self.rotation * other.translation + self.translation,
        }
    }

    /// Returns the inverse.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// Interpolates between two poses: spherically for the rotation, linearly for the translation.
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        Self {
            rotation: self.rotation.slerp(other.rotation, t),
            translation: self.translation.lerp(other.translation, t),
        }
    }

    /// Returns the rigid motion of a coordinate system from `rest` to `now`. Ignores scale. The motion is exact at the
    /// system's origin. A degenerate matrix yields no rotation.
    pub fn between(rest: &Mat4, now: &Mat4) -> Self {
        let (_, rotation, _) = (*now * rest.inverse()).to_scale_rotation_translation();
        let rotation = if rotation.is_finite() { rotation.normalize() } else { Quat::IDENTITY };
        let (from, to) = (rest.w_axis.truncate(), now.w_axis.truncate());
        Self { rotation, translation: to - rotation * from }
    }

    /// Returns the rigid motion from the points `rest` to the points `now` with the least sum of squared errors (Horn 1987,
    /// *Closed-form solution of absolute orientation using unit quaternions*). Surplus points are ignored.
    pub fn fit(rest: &[Vec3], now: &[Vec3]) -> Self {
        let count = rest.len().min(now.len());
        let mean = |points: &[Vec3]| {
            points[..count].iter().map(|p| p.as_dvec3()).sum::<DVec3>() / count.max(1) as f64
        };
        let (from, to) = (mean(rest), mean(now));
        let centered = rest
            .iter()
            .zip(now)
            .map(|(a, b)| ((a.as_dvec3() - from).as_vec3(), (b.as_dvec3() - to).as_vec3()));
        let rotation = nearest_rotation(centered);
        Self { rotation, translation: (to - rotation.as_dquat() * from).as_vec3() }
    }

    /// Returns the pose as a column-major matrix.
    pub fn matrix(&self) -> Mat4 {
        Mat4::from_rotation_translation(self.rotation, self.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes() {
        let pose = Pose { rotation: Quat::from_rotation_y(0.7), translation: Vec3::new(1.0, -2.0, 0.5) };
        let p = Vec3::new(0.3, 0.2, 0.1);
        assert!((pose.inverse().point(pose.point(p)) - p).length() < 1e-6);
        assert!((pose.after(&pose.inverse()).point(p) - p).length() < 1e-6);
    }

    #[test]
    fn between_extracts_rigid_motion_of_scaled_matrices() {
        let own = Quat::from_rotation_x(0.3);
        let rest = Mat4::from_scale_rotation_translation(Vec3::splat(2.0), own, Vec3::Y);
        let turn = Quat::from_rotation_z(0.7);
        let now = Mat4::from_scale_rotation_translation(Vec3::splat(2.0), turn * own, Vec3::X);
        let pose = Pose::between(&rest, &now);
        assert!(pose.point(Vec3::Y).distance(Vec3::X) < 1e-6);
        assert!(pose.rotation.dot(turn).abs() > 0.999_999);
        // A stretched matrix is not rigid, but its origin still maps exactly.
        let stretched = now * Mat4::from_scale(Vec3::new(3.0, 1.0, 1.0));
        let pose = Pose::between(&rest, &stretched);
        assert!(pose.point(Vec3::Y).distance(Vec3::X) < 1e-6 && pose.rotation.is_normalized());
        assert!(Pose::between(&rest, &Mat4::from_scale(Vec3::ZERO)).rotation.is_finite());
    }

    #[test]
    fn fit_is_the_motion_of_points() {
        let points: Vec<Vec3> = (0..40u32)
            .map(|i| Vec3::new((i as f32).sin(), (1.7 * i as f32).cos(), (2.3 * i as f32).sin()) * 0.1)
            .collect();
        for angle in [0.0, 0.01, 1.2, std::f32::consts::PI, -2.9] {
            let rotation = Quat::from_axis_angle(Vec3::new(0.6, -0.48, 0.64).normalize(), angle);
            let pose = Pose { rotation, translation: Vec3::new(3.0, -0.2, 0.7) };
            let moved: Vec<Vec3> = points.iter().map(|p| pose.point(*p)).collect();
            let found = Pose::fit(&points, &moved);
            let off = points.iter().map(|p| found.point(*p).distance(pose.point(*p))).fold(0.0, f32::max);
            assert!(off < 1e-6, "{angle}: {off} m");
        }
        let still = Pose::fit(&points, &points);
        assert!(still.rotation.angle_between(Quat::IDENTITY) < 1e-6 && still.translation.length() < 1e-7);
        // Too few points for a rotation still give the translation.
        for few in [&points[..0], &points[..1]] {
            let moved: Vec<Vec3> = few.iter().map(|p| *p + Vec3::X).collect();
            let found = Pose::fit(few, &moved);
            assert!(found.rotation.is_normalized());
            few.iter().for_each(|p| assert!(found.point(*p).distance(*p + Vec3::X) < 1e-6));
        }
    }

    #[test]
    fn pivot_stays() {
        let pivot = Vec3::new(0.0, 1.4, 0.0);
        let pose = Pose::about(pivot, Quat::from_rotation_z(1.0));
        assert!((pose.point(pivot) - pivot).length() < 1e-6);
    }
}
