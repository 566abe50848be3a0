//! Deviations of single strands from their path: frizz, strays and flyaways.

use super::StrandVariation;
use crate::random::{Rng, smoothstep};
use glam::{Quat, Vec3};

/// Adds fine waves to `line`, and a drift away from its path that grows toward the tip. `stray`, a uniform random
/// number from 0 to 1, selects the drift: long below the fraction of flyaways, short below the sum of the fractions of
/// flyaways and strays, else about 0.6 mm or less.
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
    let drift_start = rng.range(0.0, 0.6);
    let (sine_amplitude, cosine_amplitude) = (rng.bell3(), rng.bell3());
    let wave_count = length / rng.range(0.03, 0.08);
    let phase = rng.range(0.0, 6.3);
    let last = (line.len() - 1) as f32;
    for (i, vertex) in line.iter_mut().enumerate().skip(1) {
        let fraction = i as f32 / last;
        let drift_weight = smoothstep(drift_start, 1.15, fraction);
        let rotated_drift = Quat::IDENTITY.lerp(rotation, fraction) * drift;
        let angle = phase + fraction * wave_count * std::f32::consts::TAU;
        let wave = sine_amplitude * angle.sin() + cosine_amplitude * (1.7 * angle).cos();
        let frizz = wave * variation.frizz * smoothstep(0.0, 0.25, fraction);
        *vertex += rotated_drift * drift_weight + frizz;
    }
}
