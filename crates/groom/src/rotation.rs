//! Rotations between directions. The shaders of `tresses` compute alike (`math/rotation.wesl`).

use glam::{DMat3, DMat4, DQuat, Quat, Vec3};

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

/// Returns the rotation that turns the first vectors of `pairs` closest to the second, in the sense of least squares
/// (Horn 1987, *Closed-form solution of absolute orientation using unit quaternions*). The identity without any.
pub fn nearest_rotation(pairs: impl Iterator<Item = (Vec3, Vec3)>) -> Quat {
    let mut s = DMat3::ZERO;
    for (a, b) in pairs {
        let (a, b) = (a.as_dvec3(), b.as_dvec3());
        // Columns are the sums of `a` times one component of `b`.
        s += DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    }
    let [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]] = s.to_cols_array_2d();
    let n = DMat4::from_cols_array_2d(&[
        [xx + yy + zz, yz - zy, zx - xz, xy - yx],
        [yz - zy, xx - yy - zz, xy + yx, zx + xz],
        [zx - xz, xy + yx, yy - xx - zz, yz + zy],
        [xy - yx, zx + xz, yz + zy, zz - xx - yy],
    ]);
    let size = n.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
    if size.is_nan() || size <= 0.0 {
        return Quat::IDENTITY;
    }
    // The rotation is the eigenvector of the largest eigenvalue. Squaring leaves it alone.
    let mut power = n * (1.0 / size) + DMat4::IDENTITY;
    for _ in 0..16 {
        power = power * power;
        power = power * (1.0 / power.to_cols_array().iter().fold(1e-300, |max: f64, v| max.max(v.abs())));
    }
    let columns = [power.x_axis, power.y_axis, power.z_axis, power.w_axis];
    let longer = |best: glam::DVec4, column: glam::DVec4| {
        if column.length_squared() > best.length_squared() { column } else { best }
    };
    let [w, x, y, z] = columns.into_iter().fold(columns[0], longer).to_array();
    let rotation = DQuat::from_xyzw(x, y, z, w).normalize();
    let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
    if rotation.is_finite() { rotation.as_quat() } else { Quat::IDENTITY }
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
