//! The sphere on which roots lie: a first estimate of the skull.

use glam::{DMat3, DVec3, Vec3};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedSphere {
    /// Center, in the unit of the points.
    pub center: Vec3,
    /// Radius, in the unit of the points.
    pub radius: f32,
}

impl FittedSphere {
    /// Fits a sphere to the 70 % of the points that are closest to it, so that hair rooted in a band does not count.
    /// Returns `None` for fewer than four points or for coplanar points.
    pub fn fit(points: &[Vec3]) -> Option<Self> {
        let mut kept = points.to_vec();
        let mut sphere = least_squares(&kept)?;
        for _ in 0..8 {
            let off = |p: &Vec3| (p.distance(sphere.center) - sphere.radius).abs();
            let mut distances: Vec<f32> = points.iter().map(off).collect();
            distances.sort_unstable_by(f32::total_cmp);
            let limit = distances[(distances.len() - 1) * 7 / 10];
            kept = points.iter().copied().filter(|p| off(p) <= limit).collect();
            sphere = least_squares(&kept)?;
        }
        Some(sphere)
    }
}

/// Algebraic least-squares fit: |p|² = 2 c·p + (r² − |c|²) is linear in the center c and in the bracket.
fn least_squares(points: &[Vec3]) -> Option<FittedSphere> {
    if points.len() < 4 {
        return None;
    }
    let n = points.len() as f64;
    let mean = points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / n;
    let mean_square = points.iter().map(|p| (p.as_dvec3() - mean).length_squared()).sum::<f64>() / n;
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for p in points {
        let q = p.as_dvec3() - mean;
        matrix += DMat3::from_cols(q * q.x, q * q.y, q * q.z);
        right += q * (0.5 * (q.length_squared() - mean_square));
    }
    // Coplanar points determine no sphere.
    let scale = mean_square * n / 3.0;
    if matrix.determinant() <= 1e-6 * scale.powi(3) {
        return None;
    }
    let center = matrix.inverse() * right;
    let radius = (mean_square + center.length_squared()).sqrt() as f32;
    let center = (center + mean).as_vec3();
    (center.is_finite() && radius.is_finite() && radius > 0.0).then_some(FittedSphere { center, radius })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fit_ignores_outliers() {
        let center = Vec3::new(3.0, 90.0, -2.0);
        let mut points: Vec<Vec3> = (0..400)
            .map(|i| {
                let (a, y) = (i as f32 * 2.4, 1.0 - i as f32 / 400.0);
                let r = (1.0 - y * y).sqrt();
                center + 25.0 * Vec3::new(r * a.cos(), y, r * a.sin())
            })
            .collect();
        points.extend((0..60).map(|i| center + Vec3::new(0.0, -10.0, -40.0 - 0.1 * i as f32)));
        let sphere = FittedSphere::fit(&points).unwrap();
        assert!(sphere.center.distance(center) < 0.1 && (sphere.radius - 25.0).abs() < 0.1, "{sphere:?}");
        assert!(FittedSphere::fit(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE.with_z(0.0)]).is_none());
    }
}
