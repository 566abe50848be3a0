//! Rotations between directions. The shaders of `tresses` compute alike (`math/rotation.wesl`).

use glam::{Quat, Vec3};

/// Returns the smallest rotation from the direction of `a` to the direction of `b`. Returns the identity if either is
/// zero, and a half turn about any perpendicular axis if they are opposite.
pub fn minimal_rotation(a: Vec3, b: Vec3) -> Quat {
    let scale = (a.length_squared() * b.length_squared()).sqrt();
    let w = scale + a.dot(b);
    if w < 1e-6 * scale {
        let axis = if a.x.abs() > a.z.abs() { Vec3::new(-a.y, a.x, 0.0) } else { Vec3::new(0.0, -a.z, a.y) };
        return Quat::from_vec4(axis.normalize().extend(0.0));
    }
    let q = a.cross(b).extend(w);
    let length = q.length();
    if length > 1e-30 { Quat::from_vec4(q / length) } else { Quat::IDENTITY }
}

/// Normalized linear interpolation along the shorter arc.
pub fn nlerp(a: Quat, b: Quat, t: f32) -> Quat {
    let b = if a.dot(b) >= 0.0 { b } else { -b };
    (a * (1.0 - t) + b * t).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minimal_rotation_turns_one_direction_into_the_other() {
        let pairs = [
            (Vec3::X, Vec3::Y),
            (Vec3::new(0.1, -0.2, 0.3), Vec3::new(-2.0, 0.5, 0.1)),
            (Vec3::Z, -Vec3::Z),
            (Vec3::X, -Vec3::X),
            (Vec3::Y, Vec3::Y * 5.0),
        ];
        for (a, b) in pairs {
            let turned = minimal_rotation(a, b) * a.normalize();
            assert!(turned.distance(b.normalize()) < 1e-5, "{a} {b} {turned}");
        }
        assert_eq!(minimal_rotation(Vec3::ZERO, Vec3::X), Quat::IDENTITY);
    }
}
