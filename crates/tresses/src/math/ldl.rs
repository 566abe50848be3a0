//! LDLᵀ factorization of symmetric positive definite 3×3 matrices, for CPU references. `ldl.wesl` is the GPU version,
//! which has 4×4 matrices as well.
//!
//! An inverse by cofactors is not accurate enough: if a matrix is κ times stiffer in one direction than in another, its
//! rounding error grows with κ, and with κ² once it multiplies an equally stiff matrix. The factors are exact to the
//! rounding of the matrix.

use glam::{Mat3, Vec3};

/// Factors of a 3×3 matrix: the reciprocals of D, and L below its diagonal (21, 31, 32).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factors {
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
    pub(crate) fn solve_columns(&self, b: Mat3) -> Mat3 {
        Mat3::from_cols(self.solve(b.x_axis), self.solve(b.y_axis), self.solve(b.z_axis))
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
