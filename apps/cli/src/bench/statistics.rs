//! Medians, percentiles and line fits of measurements.

use serde::Serialize;

/// Statistics of repeated measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// Median, milliseconds.
    pub median: f64,
    /// 95th percentile, milliseconds.
    pub p95: f64,
}

impl Summary {
    /// Summarizes values in milliseconds, in any order; zeros if there are none.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self { median: percentile(&values, 0.5), p95: percentile(&values, 0.95) }
    }
}

/// Interpolates linearly between the two nearest ranks of sorted values.
pub fn percentile(sorted: &[f64], fraction: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let rank = fraction * last as f64;
    let low = rank.floor() as usize;
    sorted[low] + (sorted[(low + 1).min(last)] - sorted[low]) * rank.fract()
}

/// Fits the line `fixed + slope * x` to points, by least squares of the relative error.
pub fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let mut sums = [0.0; 5];
    for (x, y) in points.iter().filter(|(_, y)| *y > 0.0) {
        // Relative error: a millisecond weighs more at 1,000 strands than at 100,000.
        let w = 1.0 / (y * y);
        for (sum, term) in sums.iter_mut().zip([w, w * x, w * x * x, w * y, w * x * y]) {
            *sum += term;
        }
    }
    let [n, sx, sxx, sy, sxy] = sums;
    let determinant = n * sxx - sx * sx;
    if determinant <= 0.0 {
        return (0.0, 0.0);
    }
    ((sxx * sy - sx * sxy) / determinant, (n * sxy - sx * sy) / determinant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_a_ramp() {
        let summary = Summary::of((0..=100).rev().map(f64::from).collect());
        assert_eq!(summary, Summary { median: 50.0, p95: 95.0 });
        assert_eq!(Summary::of(vec![3.0]), Summary { median: 3.0, p95: 3.0 });
        assert_eq!(Summary::of(vec![]), Summary::default());
        assert_ne!(Summary::of(vec![1.0, 2.0, 9.0]).median, 9.0);
    }

    #[test]
    fn line_fits_exact_points() {
        let points: Vec<_> = [1e3, 1e4, 1e5].iter().map(|x| (*x, 2.0 + 3e-4 * x)).collect();
        let (fixed, slope) = line(&points);
        assert!((fixed - 2.0).abs() < 1e-6 && (slope - 3e-4).abs() < 1e-10);
        assert_eq!(line(&[(1.0, 1.0)]), (0.0, 0.0));
    }
}
