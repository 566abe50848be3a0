//! Deviations of single strands from their path: frizz, strays and flyaways.

use super::StrandVariation;
use crate::random::{Rng, smoothstep};
use glam::{Quat, Vec3};

/// Adds fine waves and a slow drift away from the path. `stray` is a random number from 0 to 1: below the fraction of
/// flyaways the drift is long, below the sum of both fractions it is short, and above it is minimal.
pub(crate) fn add_variation(variation: &StrandVariation, stray: f32, rng: &mut Rng, line: &mut [Vec3]) {
    let drift_length = if stray < variation.flyaways {
        variation.flyaway * rng.range(0.5, 1.3)
    } else if stray < variation.flyaways + variation.strays {
        variation.stray * rng.range(0.3, 1.2)
    } else {
        0.0006f32.min(variation.stray)
    };
    let length: f32 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
    let drift = rng.bell3().normalize_or(Vec3::X) * drift_length;
    let rotation = Quat::from_axis_angle(rng.bell3().normalize_or(Vec3::Y), rng.range(0.0, 2.5));
    let begin = rng.range(0.0, 0.6);
    let (a, b) = (rng.bell3(), rng.bell3());
    let waves = length / rng.range(0.03, 0.08);
    let phase = rng.range(0.0, 6.3);
    let last = (line.len() - 1) as f32;
    for (k, p) in line.iter_mut().enumerate().skip(1) {
        let s = k as f32 / last;
        let away = smoothstep(begin, 1.15, s);
        let rotated_drift = Quat::IDENTITY.lerp(rotation, s) * drift;
        let angle = phase + s * waves * std::f32::consts::TAU;
        let fine = (a * angle.sin() + b * (1.7 * angle).cos()) * variation.frizz * smoothstep(0.0, 0.25, s);
        *p += rotated_drift * away + fine;
    }
}
