//! Scattering by one fiber at the point that a ray hits: Chiang, Bitterli, Tappan, Burley, *A Practical and
//! Controllable Hair and Fur Model for Production Path Tracing* (2016).
//!
//! All values are `f cos`: radiance per irradiance on a plane that faces the light. As in path tracers, the offset
//! across the fiber and the refraction follow from the eye ray. Angles: θ is the inclination towards the tip, φ the
//! azimuth of the light about the fiber, measured from the azimuth of the eye.

use crate::{groom::Look, range::Range};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Number of lobes: reflection (R), transmission (TT), one internal reflection (TRT), and more of them.
pub const LOBES: usize = 4;

/// Geometry and surface of a fiber, independent of its color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberShape {
    /// Longitudinal roughness, 0.1 (wet silk) to 1.
    pub longitudinal: f32,
    /// Azimuthal roughness, 0.1 to 1.
    pub azimuthal: f32,
    /// Cuticle angle, radians. Reflected light is rotated towards the tip by twice this angle.
    pub tilt: f32,
    /// Index of refraction relative to air.
    pub eta: f32,
}

impl Default for FiberShape {
    /// Keratin in air, as in the path-traced references.
    fn default() -> Self {
        Self { longitudinal: 0.3, azimuthal: 0.3, tilt: 2f32.to_radians(), eta: 1.55 / 1.000_277 }
    }
}

impl FiberShape {
    /// Range of both roughnesses.
    pub const ROUGHNESS: Range = Look::ROUGHNESS;
    /// Range of [`tilt`](Self::tilt). Hair usually has up to 10 degrees.
    pub const TILT: Range = Look::TILT;
    /// Range of [`eta`](Self::eta).
    pub const ETA: Range = Look::IOR;

    /// Clamps all parameters to the range that the tables resolve. Parameters that are not finite become the default.
    pub fn clamped(&self) -> Self {
        let finite = |v: f32, or: f32| if v.is_finite() { v } else { or };
        let default = Self::default();
        Self {
            longitudinal: Self::ROUGHNESS.clamp(finite(self.longitudinal, default.longitudinal)),
            azimuthal: Self::ROUGHNESS.clamp(finite(self.azimuthal, default.azimuthal)),
            tilt: Self::TILT.clamp(finite(self.tilt, default.tilt)),
            eta: Self::ETA.clamp(finite(self.eta, default.eta)),
        }
    }

    /// Longitudinal variance of each lobe (Chiang, equation 7; factors of the later lobes from pbrt).
    pub fn variances(&self) -> [f64; LOBES] {
        let b = f64::from(self.longitudinal);
        let v = (0.726 * b + 0.812 * b * b + 3.7 * b.powi(20)).powi(2);
        [v, 0.25 * v, 4.0 * v, 4.0 * v]
    }

    /// Shift of each lobe towards the root, radians.
    pub fn shifts(&self) -> [f64; LOBES] {
        [-2.0, 1.0, 4.0, 0.0].map(|factor| factor * f64::from(self.tilt))
    }

    /// Scale of the azimuthal logistic distribution (Chiang, equation 8).
    pub fn scale(&self) -> f64 {
        let b = f64::from(self.azimuthal);
        (PI / 8.0).sqrt() * (0.265 * b + 1.194 * b * b + 5.372 * b.powi(22))
    }

    /// Returns sin γ of the refracted ray. `h` is the offset across the fiber, -1..1; `cos_theta` belongs to the eye.
    pub(crate) fn refracted(&self, h: f64, cos_theta: f64) -> f64 {
        let eta = f64::from(self.eta);
        let bent = (eta * eta - 1.0 + cos_theta * cos_theta).sqrt() / cos_theta.max(1e-9);
        (h / bent).clamp(-1.0, 1.0)
    }

    /// Returns the length of the path inside the fiber from wall to wall, in fiber radii.
    pub fn path(&self, h: f64, cos_theta: f64) -> f64 {
        let sin_gamma = self.refracted(h, cos_theta);
        let eta = f64::from(self.eta);
        let sin_theta_squared = (1.0 - cos_theta * cos_theta) / (eta * eta);
        2.0 * (1.0 - sin_gamma * sin_gamma).max(0.0).sqrt() / (1.0 - sin_theta_squared).sqrt()
    }

    /// Returns the Fresnel reflectance for unpolarized light.
    pub(crate) fn fresnel(&self, cosine: f64) -> f64 {
        let eta = f64::from(self.eta);
        let inside = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0).sqrt();
        let parallel = (eta * cosine - inside) / (eta * cosine + inside);
        let perpendicular = (cosine - eta * inside) / (cosine + eta * inside);
        0.5 * (parallel * parallel + perpendicular * perpendicular)
    }

    /// Returns the attenuation of each lobe. `sigma_a` is the absorption per fiber radius.
    pub(crate) fn attenuations(&self, h: f64, cos_theta: f64, sigma_a: f64) -> [f64; LOBES] {
        let f = self.fresnel(cos_theta * (1.0 - h * h).max(0.0).sqrt());
        let t = (-sigma_a * self.path(h, cos_theta)).exp();
        let through = (1.0 - f) * (1.0 - f) * t;
        [f, through, through * t * f, through * t * f * t * f / (1.0 - t * f)]
    }

    /// Returns the azimuthal distribution of lobe `p` at `phi`. The last lobe is uniform.
    pub fn around(&self, p: usize, phi: f64, h: f64, cos_theta: f64) -> f64 {
        if p == 3 {
            return 0.5 / PI;
        }
        let order = p as f64;
        let refracted = self.refracted(h, cos_theta).asin();
        logistic(phi - (2.0 * order * refracted - 2.0 * h.clamp(-1.0, 1.0).asin() + order * PI), self.scale())
    }

    /// Returns radiance per irradiance at the point where the eye ray hits the fiber. The offset across the fiber
    /// follows from `eye`. Frame: x across the fiber, y from root to tip, z along the surface normal. `sigma_a` is the
    /// absorption per radius, for each color channel.
    pub fn near(&self, eye: DVec3, light: DVec3, sigma_a: DVec3) -> DVec3 {
        self.near_along(eye, light, sigma_a, along)
    }

    /// Returns [`near`](Self::near) with another longitudinal distribution.
    pub fn near_along(&self, eye: DVec3, light: DVec3, sigma_a: DVec3, along: Longitudinal) -> DVec3 {
        let [m, n] = self.factors(eye, light, along);
        let (cos_theta, h) = (cosine(eye.y), entry(eye));
        let channel = |sigma: f64| {
            let a = self.attenuations(h, cos_theta, sigma);
            (0..LOBES).map(|p| m[p] * a[p] * n[p]).sum()
        };
        DVec3::new(channel(sigma_a.x), channel(sigma_a.y), channel(sigma_a.z))
    }

    /// Returns the longitudinal and the azimuthal factor of each lobe.
    fn factors(&self, eye: DVec3, light: DVec3, along: Longitudinal) -> [[f64; LOBES]; 2] {
        let phi = light.z.atan2(light.x) - eye.z.atan2(eye.x);
        let (v, shifts) = (self.variances(), self.shifts());
        let (cos_theta, h) = (cosine(eye.y), entry(eye));
        let m = std::array::from_fn(|p| {
            let (sin, cos) = (eye.y.clamp(-1.0, 1.0).asin() + shifts[p]).sin_cos();
            along(v[p], sin, cos.abs(), light.y, cosine(light.y))
        });
        [m, std::array::from_fn(|p| self.around(p, phi, h, cos_theta))]
    }
}

/// cos θ from sin θ.
fn cosine(sine: f64) -> f64 {
    (1.0 - sine * sine).max(0.0).sqrt()
}

/// Returns the offset across the fiber, -1..1, at which an eye ray hits it, in the frame of [`FiberShape::near`].
fn entry(eye: DVec3) -> f64 {
    -eye.x / eye.x.hypot(eye.z).max(1e-12)
}

/// The logistic distribution of scale `s`, trimmed to -π..π.
pub(crate) fn logistic(x: f64, s: f64) -> f64 {
    let x = x - 2.0 * PI * (x / (2.0 * PI)).round();
    let e = (-x.abs() / s).exp();
    let end = (-PI / s).exp();
    e / (s * (1.0 + e) * (1.0 + e)) * (1.0 + end) / (1.0 - end)
}

/// e⁻ˣ I₀(x), the modified Bessel function (Abramowitz and Stegun 9.8.1 and 9.8.2).
pub fn scaled_bessel(x: f64) -> f64 {
    let poly = |c: &[f64], t: f64| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
    if x < 3.75 {
        let t = (x / 3.75).powi(2);
        let c = [1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
        return (-x).exp() * poly(&c, t);
    }
    let c = [
        0.398_942_28,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    poly(&c, 3.75 / x) / x.sqrt()
}

/// A longitudinal distribution, with the arguments of [`along`].
pub type Longitudinal = fn(f64, f64, f64, f64, f64) -> f64;

/// Longitudinal distribution of variance `v` (d'Eon et al. 2011, equation 7). Its integral over light directions,
/// weighted by cos θ, is 1. `sin_eye` and `cos_eye` belong to the inclination of the eye after the lobe's shift,
/// `sin_light` and `cos_light` to the light.
pub fn along(v: f64, sin_eye: f64, cos_eye: f64, sin_light: f64, cos_light: f64) -> f64 {
    let (a, b) = (cos_eye * cos_light / v, sin_eye * sin_light / v);
    // A single exponential: neither large nor small v overflows.
    scaled_bessel(a) * (a - b - 1.0 / v).exp() / (v * (1.0 - (-2.0 / v).exp()))
}

/// Returns the absorption per fiber radius of melanin in the concentrations `eumelanin` (brown to black) and
/// `pheomelanin` (yellow to red) (d'Eon et al. 2011). Brown hair has about 1.3 and 0.2, blond 0.25 and 0.05, red 0.12
/// and 1.5, black 6 and 0.3.
pub fn melanin(eumelanin: f32, pheomelanin: f32) -> Vec3 {
    Vec3::new(0.419, 0.697, 1.37) * eumelanin + Vec3::new(0.187, 0.4, 1.05) * pheomelanin
}

/// Returns the divisor of a color's logarithm in Chiang, equation 9. The quotient is the square root of the absorption.
pub(crate) fn color_fit(beta_n: f32) -> f32 {
    let b = beta_n.clamp(0.0, 1.0);
    5.969 - 0.215 * b + 2.532 * b.powi(2) - 10.73 * b.powi(3) + 5.574 * b.powi(4) + 0.245 * b.powi(5)
}

/// Returns the absorption per fiber radius with which a mass of hair of azimuthal roughness `beta_n` has the linear
/// color `color` (Chiang, equation 9).
pub(crate) fn absorption_of(color: Vec3, beta_n: f32) -> Vec3 {
    let root = color.clamp(Vec3::splat(0.002), Vec3::splat(0.995)).map(f32::ln) / color_fit(beta_n);
    root * root
}

/// Inverse of `absorption_of`.
pub fn color_of(absorption: Vec3, beta_n: f32) -> Vec3 {
    (-absorption.max(Vec3::ZERO).map(f32::sqrt) * color_fit(beta_n)).map(f32::exp)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral(n: usize, lo: f64, hi: f64, f: impl Fn(f64) -> f64) -> f64 {
        let step = (hi - lo) / n as f64;
        (0..n).map(|i| f(lo + (i as f64 + 0.5) * step) * step).sum()
    }

    #[test]
    fn scaled_bessel_matches_its_integral() {
        // I0(x) = 1/π ∫ exp(x cos t) dt
        for x in [0.0, 0.3, 1.0, 3.7, 3.8, 12.0, 80.0] {
            let exact = integral(2000, 0.0, PI, |t| (x * (t.cos() - 1.0)).exp()) / PI;
            assert!((scaled_bessel(x) / exact - 1.0).abs() < 1e-6, "{x}");
        }
    }

    #[test]
    fn distributions_are_normalized() {
        for s in [0.02, 0.1, 0.5, 2.0] {
            assert!((integral(4000, -PI, PI, |x| logistic(x + 40.0, s)) - 1.0).abs() < 1e-4, "{s}");
        }
        for v in [0.004, 0.02, 0.085, 0.34, 3.0] {
            for theta in [-1.4_f64, -0.5, 0.0, 0.9] {
                let sum = integral(4000, -0.5 * PI, 0.5 * PI, |t| {
                    along(v, theta.sin(), theta.cos(), t.sin(), t.cos()) * t.cos()
                });
                assert!((sum - 1.0).abs() < 1e-4, "{v} {theta} {sum}");
            }
        }
    }

    #[test]
    fn attenuations_and_peak_match_closed_forms() {
        let shape = FiberShape::default();
        // Normal incidence: reflectance ((η-1)/(η+1))², path of two radii.
        let eta = f64::from(shape.eta);
        let f = ((eta - 1.0) / (eta + 1.0)).powi(2);
        let a = shape.attenuations(0.0, 1.0, 0.4);
        let t = (-0.8_f64).exp();
        let expected = [f, (1.0 - f).powi(2) * t, (1.0 - f).powi(2) * f * t * t];
        for p in 0..3 {
            assert!((a[p] / expected[p] - 1.0).abs() < 1e-6);
        }
        // Without absorption no light is lost.
        for h in [0.0, 0.5, 0.99] {
            for cos in [1.0, 0.5, 0.1] {
                assert!((shape.attenuations(h, cos, 0.0).iter().sum::<f64>() - 1.0).abs() < 1e-9);
            }
        }
        // A narrow lobe mirrors light about the tilted cuticle: θ_light = -θ_eye + 2α.
        let shape = FiberShape { longitudinal: 0.1, ..shape };
        let (v, turn) = (shape.variances()[0], shape.shifts()[0]);
        let peak = (0..20_000)
            .map(|i| -1.0 + 1e-4 * f64::from(i))
            .max_by(|a, b| {
                let m = |t: f64| along(v, (0.4 + turn).sin(), (0.4 + turn).cos(), t.sin(), t.cos());
                m(*a).total_cmp(&m(*b))
            })
            .unwrap();
        assert!((peak - (-0.4 + 2.0 * f64::from(shape.tilt))).abs() < 0.01, "{peak}");
    }

    /// Fibers without absorption return all light of a white sky.
    #[test]
    fn white_furnace() {
        for (m, n) in [(0.1, 0.2), (0.3, 0.3), (0.7, 0.9)] {
            let shape = FiberShape { longitudinal: m, azimuthal: n, ..Default::default() };
            for (theta, gamma) in [(0.0_f64, 0.3_f64), (0.8, -0.9), (-1.2, 1.3)] {
                let eye = DVec3::new(-gamma.sin() * theta.cos(), theta.sin(), gamma.cos() * theta.cos());
                let sum = |sigma: f64| {
                    integral(300, -1.0, 1.0, |y| {
                        let r = (1.0 - y * y).sqrt();
                        integral(200, -PI, PI, |phi| {
                            let light = DVec3::new(r * phi.cos(), y, r * phi.sin());
                            shape.near(eye, light, DVec3::splat(sigma)).x
                        })
                    })
                };
                assert!((sum(0.0) - 1.0).abs() < 0.01, "{m} {n} {theta} {}", sum(0.0));
                assert!(sum(0.1) < 0.97);
            }
        }
    }

    #[test]
    fn colors_and_melanin_give_expected_absorption() {
        assert!((melanin(1.3, 0.2) - Vec3::new(0.5821, 0.9861, 1.991)).length() < 1e-4);
        let brown = absorption_of(Vec3::new(0.1, 0.05, 0.02), 0.3);
        assert!(brown.x < brown.y && brown.y < brown.z && brown.is_finite());
        assert!(absorption_of(Vec3::ONE, 0.3).max_element() < 1e-5);
        // A value of the fit, worked out by hand: ln 0.5 / 5.915..., squared.
        let fit = 5.969 - 0.0645 + 0.22788 - 0.28971 + 0.0451494 + 0.00059535;
        assert!((absorption_of(Vec3::splat(0.5), 0.3).x - (0.5_f32.ln() / fit).powi(2)).abs() < 1e-6);
    }
}
