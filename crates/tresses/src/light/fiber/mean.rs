//! Average scattering by many fibers: the quantities of dual scattering (Zinke, Yuksel, Weber, Keyser, *Dual Scattering
//! Approximation for Fast Multiple Scattering in Hair*, 2008), integrated from the lobes that shade a single fiber.

use super::{
    bsdf::LOBES,
    far::{AZIMUTHS, COSINES, FarField, HUES, azimuth, cosine},
};
use std::f64::consts::PI;

/// Averages for light that arrives from a half circle of azimuths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MeanScattering {
    /// Fraction scattered forward, into the opposite half circle.
    pub forward: f32,
    /// Fraction scattered backward.
    pub backward: f32,
    /// Longitudinal variance of forward scattering.
    pub forward_variance: f32,
    /// Longitudinal variance of backward scattering.
    pub backward_variance: f32,
    /// Fraction that the surrounding hair scatters back, by one or three backward scatterings and any number of forward
    /// ones (Zinke, equations 13 to 15).
    pub local: f32,
    /// Longitudinal variance of `local` (equation 17).
    pub local_variance: f32,
    /// Shift of `local` towards the root, radians (equation 16).
    pub local_shift: f32,
    /// Share of the last lobe.
    pub rest: f32,
}

impl MeanScattering {
    /// Computes the averages from each lobe's forward and backward fraction. `density` is Zinke's d_b.
    fn new(
        forward: [f64; LOBES],
        backward: [f64; LOBES],
        variances: [f64; LOBES],
        shifts: [f64; LOBES],
        density: f64,
        rest: f64,
    ) -> Self {
        let sum = |fractions: &[f64; LOBES]| fractions.iter().sum::<f64>();
        let mean = |fractions: &[f64; LOBES], of: &[f64; LOBES]| {
            fractions.iter().zip(of).map(|(a, v)| a * v).sum::<f64>() / sum(fractions).max(1e-9)
        };
        // If fibers passed on all light, the series below would diverge.
        let (f, b) = (sum(&forward).min(0.99), sum(&backward));
        let (f2, b2) = (f * f, b * b);
        let left = 1.0 - f2;
        let local = b * f2 / left + b * b2 * f2 / left.powi(3);
        let (vf, vb) = (mean(&forward, &variances), mean(&backward, &variances));
        let deviation = (1.0 + density * f2)
            * (b * (2.0 * vf + vb).sqrt() + b * b2 * (2.0 * vf + 3.0 * vb).sqrt())
            / (b + b * b2 * (2.0 * vf.sqrt() + 3.0 * vb.sqrt())).max(1e-9);
        let shift = mean(&backward, &shifts) * (1.0 - 2.0 * b2 / (left * left))
            + mean(&forward, &shifts) * (2.0 * left * left + 4.0 * f2 * b2) / left.powi(3);
        Self {
            forward: f as f32,
            backward: b as f32,
            forward_variance: vf as f32,
            backward_variance: vb as f32,
            local: local as f32,
            local_variance: (deviation * deviation) as f32,
            local_shift: shift.clamp(-0.5, 0.5) as f32,
            rest: rest as f32,
        }
    }
}

/// Returns a table of [`MeanScattering`]s, indexed `hue * COSINES + cosine`.
pub(crate) fn table(far: &FarField, density: f32) -> Vec<MeanScattering> {
    let (variances, shifts) = (far.shape().variances(), far.shape().shifts());
    let mut table = Vec::with_capacity((HUES * COSINES) as usize);
    for u in 0..HUES {
        let sigma = -2.0 * (f64::from(u) / f64::from(HUES - 1)).max(1e-6).ln();
        for c in 0..COSINES {
            let rest = f64::from(far.rest[(u * COSINES + c) as usize]);
            let (mut forward, mut backward) = ([0.0; LOBES], [0.0; LOBES]);
            for i in 0..AZIMUTHS {
                let at = &far.direct[(c * AZIMUTHS + i) as usize];
                // Both sides of the circle; its two end points count once.
                let ends = if i == 0 || i + 1 == AZIMUTHS { 1.0 } else { 2.0 };
                let step = ends * PI / f64::from(AZIMUTHS - 1);
                // Light from a random azimuth of a half circle, deflected by π - φ, stays in the opposite half circle
                // with the probability φ/π.
                let on = azimuth(i) / PI;
                for (p, n) in at.densities(sigma, rest).into_iter().enumerate() {
                    forward[p] += n * step * on;
                    backward[p] += n * step * (1.0 - on);
                }
            }
            debug_assert!(cosine(c) > 0.0);
            table.push(MeanScattering::new(forward, backward, variances, shifts, density.into(), rest));
        }
    }
    table
}

/// Returns the forward fraction for each hue of a [`table`], averaged over light from all directions. Light across the
/// fiber counts most, because it meets the largest cross-section.
pub(crate) fn forward(table: &[MeanScattering]) -> Vec<f32> {
    let hue = |means: &[MeanScattering]| {
        // On a sphere, the inclination θ covers cos θ dθ, and a fiber's projected width is proportional to cos θ.
        let angle = |c: usize| cosine(c.min(means.len() - 1) as u32).acos();
        let weight = |c: usize| {
            let step = 0.5 * (angle(c.saturating_sub(1)) - angle(c + 1));
            (cosine(c as u32).powi(2) * step) as f32
        };
        let total: f32 = (0..means.len()).map(weight).sum();
        means.iter().enumerate().map(|(c, mean)| weight(c) * mean.forward).sum::<f32>() / total
    };
    table.chunks(COSINES as usize).map(hue).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::fiber::FiberShape;

    #[test]
    fn forward_and_backward_sum_to_one() {
        let far = FarField::new(&FiberShape::default());
        let table = table(&far, 0.7);
        let white = &table[((HUES - 1) * COSINES) as usize..];
        for (c, mean) in white.iter().enumerate().skip(1) {
            assert!((mean.forward + mean.backward - 1.0).abs() < 0.01, "{c} {mean:?}");
        }
        // Most light is scattered forward, and absorption reduces it. Surface reflection remains.
        let level = |u: u32| table[(u * COSINES + COSINES - 1) as usize];
        assert!(level(HUES - 1).forward > 0.6);
        for u in 1..HUES {
            assert!(level(u).forward > level(u - 1).forward && level(u).local >= level(u - 1).local);
        }
        assert!(level(0).backward > 0.02 && level(0).local < 0.01);
        assert!(table.iter().all(|m| m.local_variance.is_finite() && m.local_variance >= 0.0));
    }

    /// Compares the formulas with values worked out by hand.
    #[test]
    fn zinke_formulas_match_hand_computed_values() {
        let m = MeanScattering::new(
            [0.0, 0.5, 0.0, 0.0],
            [0.2, 0.0, 0.0, 0.0],
            [0.09, 0.04, 0.0, 0.0],
            [-0.1, 0.05, 0.0, 0.0],
            0.7,
            0.0,
        );
        let local = 0.2 * 0.25 / 0.75 + 0.008 * 0.25 / 0.421_875;
        assert!((m.local - local).abs() < 1e-6);
        let turn = -0.1 * (1.0 - 2.0 * 0.04 / 0.5625) + 0.05 * (2.0 * 0.5625 + 4.0 * 0.25 * 0.04) / 0.421_875;
        assert!((m.local_shift - turn).abs() < 1e-6);
        let deviation =
            1.175 * (0.2 * 0.17_f32.sqrt() + 0.008 * 0.35_f32.sqrt()) / (0.2 + 0.008 * (0.4 + 0.9));
        assert!((m.local_variance - deviation * deviation).abs() < 1e-5);
    }
}
