//! LDLᵀ factorization of symmetric positive definite 3×3 and 4×4 matrices. `ldl.wesl` is the GPU version.
//!
//! An inverse by cofactors is not accurate enough: if a matrix is κ times stiffer in one direction than in another, its
//! rounding error grows with κ, and with κ² once it multiplies an equally stiff matrix. The factors are exact to the
//! rounding of the matrix.

use glam::{Mat3, Mat4, Vec3, Vec4, Vec4Swizzles};

/// Factors of a 3×3 matrix: the reciprocals of D, and L below its diagonal (21, 31, 32).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    d: Vec3,
    l: Vec3,
}

impl Factors {
    /// Factors `m`. Reads only its lower triangle.
    pub fn new(m: Mat3) -> Self {
        let d1 = 1.0 / m.x_axis.x;
        let l21 = m.x_axis.y * d1;
        let l31 = m.x_axis.z * d1;
        let d2 = 1.0 / (m.y_axis.y - l21 * m.x_axis.y);
        let t = m.y_axis.z - l31 * m.x_axis.y;
        let l32 = t * d2;
        let d3 = 1.0 / (m.z_axis.z - l31 * m.x_axis.z - l32 * t);
        Self { d: Vec3::new(d1, d2, d3), l: Vec3::new(l21, l31, l32) }
    }

    /// Solves `m x = b` for `x`.
    pub fn solve(&self, b: Vec3) -> Vec3 {
        let y2 = b.y - self.l.x * b.x;
        let y3 = b.z - self.l.y * b.x - self.l.z * y2;
        let x3 = y3 * self.d.z;
        let x2 = y2 * self.d.y - self.l.z * x3;
        Vec3::new(b.x * self.d.x - self.l.x * x2 - self.l.y * x3, x2, x3)
    }

    /// Solves for three right-hand sides.
    pub fn solve_columns(&self, b: Mat3) -> Mat3 {
        Mat3::from_cols(self.solve(b.x_axis), self.solve(b.y_axis), self.solve(b.z_axis))
    }
}

/// Factors of a 4×4 matrix: the reciprocals of D, and L below its diagonal (21, 31, 41; 32, 42, 43).
#[cfg_attr(not(test), allow(dead_code))] // Used only by tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors4 {
    d: Vec4,
    l: [Vec3; 2],
}

#[cfg_attr(not(test), allow(dead_code))]
impl Factors4 {
    /// Factors `m`. Reads only its lower triangle.
    pub fn new(m: Mat4) -> Self {
        let d1 = 1.0 / m.x_axis.x;
        let l1 = m.x_axis.yzw() * d1;
        let d2 = 1.0 / (m.y_axis.y - l1.x * m.x_axis.y);
        let t3 = m.y_axis.z - l1.y * m.x_axis.y;
        let t4 = m.y_axis.w - l1.z * m.x_axis.y;
        let (l32, l42) = (t3 * d2, t4 * d2);
        let d3 = 1.0 / (m.z_axis.z - l1.y * m.x_axis.z - l32 * t3);
        let t43 = m.z_axis.w - l1.z * m.x_axis.z - l42 * t3;
        let l43 = t43 * d3;
        let d4 = 1.0 / (m.w_axis.w - l1.z * m.x_axis.w - l42 * t4 - l43 * t43);
        Self { d: Vec4::new(d1, d2, d3, d4), l: [l1, Vec3::new(l32, l42, l43)] }
    }

    /// Solves `m x = b` for `x`.
    pub fn solve(&self, b: Vec4) -> Vec4 {
        let [l1, l2] = self.l;
        let y2 = b.y - l1.x * b.x;
        let y3 = b.z - l1.y * b.x - l2.x * y2;
        let y4 = b.w - l1.z * b.x - l2.y * y2 - l2.z * y3;
        let x4 = y4 * self.d.w;
        let x3 = y3 * self.d.z - l2.z * x4;
        let x2 = y2 * self.d.y - l2.x * x3 - l2.y * x4;
        Vec4::new(b.x * self.d.x - l1.x * x2 - l1.y * x3 - l1.z * x4, x2, x3, x4)
    }

    /// Solves for four right-hand sides.
    pub fn solve_columns(&self, b: Mat4) -> Mat4 {
        Mat4::from_cols(
            self.solve(b.x_axis),
            self.solve(b.y_axis),
            self.solve(b.z_axis),
            self.solve(b.w_axis),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    /// Returns a matrix with eigenvalue `stiff` along an oblique direction and 1 across it.
    fn needle(stiff: f32) -> Mat3 {
        let turn = Mat3::from_quat(Quat::from_xyzw(0.3, -0.5, 0.2, 0.8).normalize());
        let m = turn * Mat3::from_diagonal(Vec3::new(1.0, stiff, 1.0)) * turn.transpose();
        (m + m.transpose()) * 0.5
    }

    #[test]
    fn solves_three_rows() {
        let m = needle(7.0);
        let x = Vec3::new(0.3, -1.2, 0.7);
        assert!(Factors::new(m).solve(m * x).distance(x) < 1e-5);
        assert!((Factors::new(m).solve_columns(m) - Mat3::IDENTITY).x_axis.length() < 1e-5);
    }

    #[test]
    fn solves_four_rows() {
        let turn = |i: f32| Mat4::from_quat(Quat::from_xyzw(0.3, i, 0.2, 0.8).normalize());
        let skew = Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::Z, Vec4::new(0.4, -0.2, 0.7, 1.0));
        let m = skew.transpose() * turn(0.1) * Mat4::from_diagonal(Vec4::new(1.0, 30.0, 3.0, 9.0));
        let m = m * turn(0.1).transpose() * skew;
        let x = Vec4::new(0.3, -1.2, 0.7, 2.0);
        assert!(Factors4::new(m).solve(m * x).distance(x) < 1e-4);
        let all = Factors4::new(m).solve_columns(m) - Mat4::IDENTITY;
        assert!(all.to_cols_array().iter().all(|c| c.abs() < 1e-4), "{all}");
    }

    #[test]
    fn stiff_coupling_stays_accurate() {
        // The Schur complement K − K M⁻¹ K of two vertices joined by a stiff edge. Its remainder along the edge is
        // small, and an inverse by cofactors loses it.
        let k = needle(1e5) - Mat3::IDENTITY;
        let m = k + Mat3::IDENTITY;
        let exact = {
            let (k, m) = (k.as_dmat3(), m.as_dmat3());
            k - k * (m.inverse() * k)
        };
        let error =
            |found: Mat3| (found.as_dmat3() - exact).to_cols_array().iter().fold(0f64, |w, c| w.max(c.abs()));
        let (ours, cofactors) =
            (error(k - k * Factors::new(m).solve_columns(k)), error(k - k * (m.inverse() * k)));
        println!("off by {ours} with factors, by {cofactors} with cofactors");
        assert!(ours < 0.05 && cofactors > 10.0 * ours);
    }
}
