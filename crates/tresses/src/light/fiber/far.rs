//! Far field: scattering by a fiber thinner than a pixel, averaged over its width and stored as moments that all colors
//! share.
//!
//! Absorption acts on a lobe as `exp(-σ l)`, where the path length `l` inside the fiber varies a little with the offset
//! `h` across it. For each lobe and azimuth the table holds the weight, the mean path length and its variance:
//! `Σ exp(-σ l) ≈ W exp(-σ l̄ + σ² var/2)`. The error is below 0.2 % of the sum for any hair that is not black, and one
//! fetch serves all channels and any melanin.

use super::bsdf::{FiberShape, LOBES};
use std::f64::consts::PI;
#[cfg(test)]
use {
    super::bsdf::along,
    glam::{DVec3, Vec3},
};

/// Azimuth steps, from the eye's azimuth to the opposite one.
pub const AZIMUTHS: u32 = 96;
/// Steps of the eye's cos θ, 0 to 1.
pub const COSINES: u32 = 32;
/// Steps of [`hue`], 0 to 1.
pub const HUES: u32 = 32;
/// Samples over half the width of a fiber.
const ENTRIES: usize = 96;

/// Returns the table coordinate of an absorption: 1 for none, 0 for infinite. Light that passes a fiber is a smooth
/// function of it.
pub fn hue(sigma_a: f64) -> f64 {
    (-0.5 * sigma_a).exp()
}

/// Azimuthal part of the first three lobes at one azimuth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AzimuthalLobes {
    /// Density without absorption.
    pub weight: [f32; 3],
    /// Mean path length inside the fiber of the second and third lobe, radii.
    pub path: [f32; 2],
    /// Variance of those path lengths.
    pub spread: [f32; 2],
}

impl AzimuthalLobes {
    /// Returns the density of each lobe with absorption. `rest` is the share of the last lobe, which is uniform.
    pub fn densities(&self, sigma_a: f64, rest: f64) -> [f64; LOBES] {
        let through = |i: usize| {
            // At high absorption the two moments overestimate the little that passes.
            let bend = (0.5 * sigma_a * sigma_a * f64::from(self.spread[i])).min(0.5);
            f64::from(self.weight[i + 1]) * (bend - sigma_a * f64::from(self.path[i])).exp()
        };
        [f64::from(self.weight[0]), through(0), through(1), rest * 0.5 / PI]
    }
}

/// Moments of the lobes over azimuth and cos θ.
#[derive(Clone, Debug)]
pub(crate) struct FarField {
    shape: FiberShape,
    /// Moments for light from one direction, indexed `cosine * AZIMUTHS + azimuth`.
    pub(crate) direct: Vec<AzimuthalLobes>,
    /// Moments for light from the half circle around that direction.
    pub(crate) wide: Vec<AzimuthalLobes>,
    /// Share of the last lobe, indexed `hue * COSINES + cosine`.
    pub rest: Vec<f32>,
}

/// Weighted sums over path lengths: 1, l, l².
#[derive(Clone, Copy, Default)]
struct Moments([f64; 3]);

impl Moments {
    fn add(&mut self, weight: f64, path: f64) {
        self.0 = [self.0[0] + weight, self.0[1] + weight * path, self.0[2] + weight * path * path];
    }

    fn around(lobes: [Self; 3]) -> AzimuthalLobes {
        let mean = |m: Self| m.0[1] / m.0[0].max(1e-30);
        let variance = |m: Self| (m.0[2] / m.0[0].max(1e-30) - mean(m) * mean(m)).max(0.0);
        AzimuthalLobes {
            weight: lobes.map(|m| m.0[0] as f32),
            path: [mean(lobes[1]) as f32, mean(lobes[2]) as f32],
            spread: [variance(lobes[1]) as f32, variance(lobes[2]) as f32],
        }
    }
}

/// Returns the cosine at step `i`. It is never 0, where a fiber has no cross-section.
pub(super) fn cosine(i: u32) -> f64 {
    (f64::from(i) / f64::from(COSINES - 1)).max(0.01)
}

/// Returns the azimuth at step `i`.
pub(super) fn azimuth(i: u32) -> f64 {
    PI * f64::from(i) / f64::from(AZIMUTHS - 1)
}

/// Returns offsets across the fiber, evenly spaced in angle, and the share of the width that each represents.
fn entries() -> impl Iterator<Item = (f64, f64)> {
    let step = 0.5 * PI / ENTRIES as f64;
    // The sum of the weights is 1 within 1e-5.
    (0..ENTRIES).map(move |i| ((i as f64 + 0.5) * step).sin_cos()).map(move |(sin, cos)| (sin, cos * step))
}

impl FarField {
    /// Integrates over the fiber's width, which takes tens of milliseconds.
    pub fn new(shape: &FiberShape) -> Self {
        let shape = shape.clamped();
        let (mut direct, mut wide, mut rest) = (Vec::new(), Vec::new(), Vec::new());
        for c in 0..COSINES {
            let sums = Self::row(&shape, cosine(c));
            direct.extend(sums.iter().map(|lobes| Moments::around(*lobes)));
            wide.extend((0..AZIMUTHS).map(|i| Moments::around(half_circle(&sums, i))));
        }
        for u in 0..HUES {
            let sigma = -2.0 * (f64::from(u) / f64::from(HUES - 1)).max(1e-6).ln();
            for c in 0..COSINES {
                let fraction =
                    entries().map(|(h, w)| w * shape.attenuations(h, cosine(c), sigma)[3]).sum::<f64>();
                rest.push(fraction as f32);
            }
        }
        Self { shape, direct, wide, rest }
    }

    /// Returns the moments of the first three lobes at every azimuth.
    fn row(shape: &FiberShape, cos_theta: f64) -> Vec<[Moments; 3]> {
        let mut sums = vec![[Moments::default(); 3]; AZIMUTHS as usize];
        for (h, width) in entries() {
            let f = shape.fresnel(cos_theta * (1.0 - h * h).sqrt());
            let path = shape.path(h, cos_theta);
            let through = (1.0 - f) * (1.0 - f);
            for (p, fraction) in [f, through, through * f].into_iter().enumerate() {
                for (i, sum) in sums.iter_mut().enumerate() {
                    // The other half of the width is the mirror image.
                    let phi = azimuth(i as u32);
                    let n = shape.around(p, phi, h, cos_theta) + shape.around(p, -phi, h, cos_theta);
                    sum[p].add(width * fraction * 0.5 * n, p as f64 * path);
                }
            }
        }
        sums
    }

    /// Shape of the fiber, clamped to the range of the tables.
    pub fn shape(&self) -> &FiberShape {
        &self.shape
    }

    /// Interpolates the moments between the steps, as a GPU sampler does.
    #[cfg(test)]
    pub(crate) fn around(table: &[AzimuthalLobes], phi: f64, cos_theta: f64) -> AzimuthalLobes {
        let grid = |v: f64, n: u32| {
            let at = v.clamp(0.0, 1.0) * f64::from(n - 1);
            let low = (at as u32).min(n - 2);
            (low as usize, (at - f64::from(low)) as f32)
        };
        let ((i, x), (j, y)) = (grid(phi.abs() / PI, AZIMUTHS), grid(cos_theta, COSINES));
        let mut out = AzimuthalLobes::default();
        for (k, w) in [(0, (1.0 - x) * (1.0 - y)), (1, x * (1.0 - y)), (2, (1.0 - x) * y), (3, x * y)] {
            let at = &table[(j + k / 2) * AZIMUTHS as usize + i + k % 2];
            (0..3).for_each(|p| out.weight[p] += w * at.weight[p]);
            (0..2).for_each(|p| out.path[p] += w * at.path[p]);
            (0..2).for_each(|p| out.spread[p] += w * at.spread[p]);
        }
        out
    }

    /// Interpolates the share of the last lobe between the steps.
    #[cfg(test)]
    pub fn rest(&self, sigma_a: f64, cos_theta: f64) -> f64 {
        let (u, c) = (hue(sigma_a) * f64::from(HUES - 1), cos_theta.clamp(0.0, 1.0) * f64::from(COSINES - 1));
        let (i, j) = ((u as u32).min(HUES - 2), (c as u32).min(COSINES - 2));
        let (x, y) = (u - f64::from(i), c - f64::from(j));
        let at = |i: u32, j: u32| f64::from(self.rest[(i * COSINES + j) as usize]);
        (at(i, j) * (1.0 - y) + at(i, j + 1) * y) * (1.0 - x)
            + (at(i + 1, j) * (1.0 - y) + at(i + 1, j + 1) * y) * x
    }

    /// Returns radiance per irradiance of a whole fiber. All vectors are unit vectors; `sigma_a` is the absorption per
    /// radius and channel. CPU reference of the sum of `fiber_narrow` and `fiber_wide` in `fiber.wesl`.
    #[cfg(test)]
    pub fn scatter(&self, tangent: Vec3, eye: Vec3, light: Vec3, sigma_a: Vec3) -> Vec3 {
        let [t, e, l] = [tangent, eye, light].map(|v| DVec3::from(v).normalize());
        let (sin_eye, sin_light) = (t.dot(e), t.dot(l));
        let [cos_eye, cos_light] = [sin_eye, sin_light].map(|s: f64| (1.0 - s * s).max(0.0).sqrt());
        let cos_phi = (e.dot(l) - sin_eye * sin_light) / (cos_eye * cos_light).max(1e-9);
        let around = Self::around(&self.direct, cos_phi.clamp(-1.0, 1.0).acos(), cos_eye);
        let (v, shifts) = (self.shape.variances(), self.shape.shifts());
        let channel = |sigma: f32| {
            let sigma = f64::from(sigma);
            let n = around.densities(sigma, self.rest(sigma, cos_eye));
            let m = |p: usize| {
                let (sin, cos) = (sin_eye.clamp(-1.0, 1.0).asin() + shifts[p]).sin_cos();
                along(v[p], sin, cos.abs(), sin_light, cos_light)
            };
            (0..LOBES).map(|p| m(p) * n[p]).sum::<f64>() as f32
        };
        sigma_a.map(channel)
    }
}

/// Returns the mean over the half circle of light around step `i`.
fn half_circle(sums: &[[Moments; 3]], i: u32) -> [Moments; 3] {
    let last = AZIMUTHS - 1;
    let radius = f64::from(last) * 0.5;
    let mut out = [Moments::default(); 3];
    // Each step around the circle, and the fraction of it within reach.
    for k in 0..2 * last {
        let offset = (f64::from(k) - f64::from(i)).rem_euclid(2.0 * f64::from(last));
        let inside = (radius + 0.5 - offset.min(2.0 * f64::from(last) - offset)).clamp(0.0, 1.0);
        let from = &sums[k.min(2 * last - k) as usize];
        for (sum, m) in out.iter_mut().zip(from) {
            (0..3).for_each(|j| sum.0[j] += m.0[j] * inside / f64::from(last));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the table with the sum over the width, between its steps.
    #[test]
    fn moments_approximate_the_sum() {
        for (n, bound) in [(0.3, 0.012), (0.9, 0.012), (0.15, 0.03)] {
            let shape = FiberShape { azimuthal: n, ..Default::default() };
            let far = FarField::new(&shape);
            let mut worst = 0.0_f64;
            for sigma in [0.0, 0.1, 0.6, 2.0, 4.0] {
                for k in 0..40 {
                    let (phi, cos) = (0.0785 * f64::from(k), 0.25 + 0.0181 * f64::from(k));
                    let tabled =
                        FarField::around(&far.direct, phi, cos).densities(sigma, far.rest(sigma, cos));
                    let exact: f64 = entries()
                        .flat_map(|(h, w)| [(h, w), (-h, w)])
                        .map(|(h, w)| {
                            let a = shape.attenuations(h, cos, sigma);
                            0.5 * w * (0..4).map(|p| a[p] * shape.around(p, phi, h, cos)).sum::<f64>()
                        })
                        .sum();
                    worst = worst.max((tabled.iter().sum::<f64>() - exact).abs() / (exact + 0.01));
                }
            }
            assert!(worst < bound, "{n}: {worst}");
        }
    }

    #[test]
    fn white_furnace() {
        let far = FarField::new(&FiberShape::default());
        for theta in [0.0_f32, 0.6, -1.3] {
            let eye = Vec3::new(theta.cos(), theta.sin(), 0.0);
            let sum = |sigma: f32| {
                let (rings, steps) = (80, 90);
                let mut sum = 0.0;
                for i in 0..rings {
                    let y = (i as f32 + 0.5) / rings as f32 * 2.0 - 1.0;
                    for j in 0..steps {
                        let (sin, cos) = (std::f32::consts::TAU * j as f32 / steps as f32).sin_cos();
                        let light = Vec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin);
                        sum += far.scatter(Vec3::Y, eye, light, Vec3::splat(sigma)).x;
                    }
                }
                sum * 4.0 * std::f32::consts::PI / (rings * steps) as f32
            };
            assert!((sum(0.0) - 1.0).abs() < 0.01, "{theta} {}", sum(0.0));
            assert!(sum(0.2) < 0.9);
        }
    }

    /// The sum over all azimuths does not depend on the averaging over half circles.
    #[test]
    fn half_circles_conserve_energy() {
        let far = FarField::new(&FiberShape::default());
        let last = AZIMUTHS as usize - 1;
        for c in [3, 16, 31] {
            for p in 0..3 {
                let total = |table: &[AzimuthalLobes]| {
                    let row = &table[c * AZIMUTHS as usize..][..AZIMUTHS as usize];
                    let ends = 0.5 * (row[0].weight[p] + row[last].weight[p]);
                    row[1..last].iter().map(|a| a.weight[p]).sum::<f32>() + ends
                };
                assert!((total(&far.direct) / total(&far.wide) - 1.0).abs() < 2e-3, "{c} {p}");
            }
        }
    }
}
