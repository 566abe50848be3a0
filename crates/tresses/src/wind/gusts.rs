//! Wind gusts: a frozen velocity field that the mean wind carries past the head.
//!
//! The field is a sum of plane waves with random directions and phases. Each wave's amplitude is perpendicular to its
//! direction, so the sum is divergence-free (Kraichnan 1970). The waves share the energy by von Kármán's spectrum,
//! which falls with k^-5/3 for wave numbers above one over the length scale. Waves longer than the grid appear as slow
//! changes of the wind's strength and direction. The field passes without changing: Taylor's hypothesis of frozen
//! turbulence.

use super::params::{GustMode, MAX_GUSTS, Wind};
use crate::math::hash::pcg;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The waves of one wind.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Gusts {
    /// Wave vector (radians per meter), phase (radians) and amplitude, scaled to a total standard deviation of 1.
    modes: Vec<(DVec3, f64, DVec3)>,
}

impl Gusts {
    /// Creates the gusts of `wind`, down to waves that a grid with cells of edge `cell` (meters) can resolve.
    pub fn new(wind: &Wind, cell: f32) -> Self {
        if wind.gusts == 0.0 {
            return Self::default();
        }
        let mut state = pcg(wind.seed ^ 0x5bd1_e995);
        let mut random = || {
            state = pcg(state);
            f64::from(state) / f64::from(u32::MAX)
        };
        // Von Kármán: the energy's peak is near one over this length.
        let length = 1.339 * f64::from(wind.gust_length);
        let (min_wavenumber, max_wavenumber) = (0.1 / length, (0.5 * PI / f64::from(cell)).max(1.0 / length));
        let energy = |k: f64| (k * length).powi(4) / (1.0 + (k * length).powi(2)).powf(17.0 / 6.0);
        let mut modes: Vec<_> = (0..MAX_GUSTS)
            .map(|i| {
                // Equal steps of log k, in which the energy is k E(k), and evenly distributed directions.
                let k = min_wavenumber
                    * (max_wavenumber / min_wavenumber).powf((i as f64 + random()) / MAX_GUSTS as f64);
                let height = 2.0 * ((i * 11 % MAX_GUSTS) as f64 + random()) / MAX_GUSTS as f64 - 1.0;
                let azimuth = TAU * random();
                let flat = (1.0 - height * height).max(0.0).sqrt();
                let direction = DVec3::new(flat * azimuth.cos(), height, flat * azimuth.sin());
                let (a, b) = direction.any_orthonormal_pair();
                let roll = TAU * random();
                let amplitude = (a * roll.cos() + b * roll.sin()) * (k * energy(k)).sqrt();
                (direction * k, TAU * random(), amplitude)
            })
            .collect();
        // The mean square of a cosine is one half; there are three components.
        let sum: f64 = modes.iter().map(|(_, _, a)| 0.5 * a.length_squared()).sum();
        for (_, _, amplitude) in &mut modes {
            *amplitude *= (3.0 / sum).sqrt();
        }
        Self { modes }
    }

    /// Returns the waves relative to the grid's corner (meters), when the air has traveled `way` (meters) in total.
    /// `deviation` is the standard deviation of a velocity component, m/s; `cell` is in meters.
    pub fn at(&self, corner: DVec3, travel: DVec3, deviation: f64, cell: f32) -> Vec<GustMode> {
        let mode = |(wave, phase, amplitude): &(DVec3, f64, DVec3)| GustMode {
            wave: (*wave * f64::from(cell)).as_vec3(),
            phase: (wave.dot(corner - travel) + phase).rem_euclid(TAU) as f32,
            amplitude: (*amplitude * deviation).as_vec3(),
            _pad: 0.0,
        };
        self.modes.iter().map(mode).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Returns the gust velocity at `x` (meters).
    fn sum(gusts: &Gusts, x: DVec3) -> DVec3 {
        gusts.modes.iter().map(|(k, phase, a)| *a * (k.dot(x) + phase).cos()).sum()
    }

    #[test]
    fn gusts_have_requested_intensity_and_no_divergence() {
        let wind = Wind { gusts: 0.3, gust_length: 0.5, ..Wind::new(Vec3::X * 5.0) };
        let gusts = Gusts::new(&wind, 0.04);
        let points = || {
            (0..20_000)
                .map(|i| DVec3::new(f64::from(i) * 0.37, f64::from(i % 117) * 1.9, f64::from(i % 71) * 3.1))
        };
        let mean: f64 = points().map(|x| sum(&gusts, x).length_squared()).sum::<f64>() / 20_000.0;
        assert!((mean / 3.0 - 1.0).abs() < 0.1, "{mean}");
        for (k, _, a) in &gusts.modes {
            assert!(k.dot(*a).abs() < 1e-9 * k.length() * a.length());
        }
        assert_eq!(gusts, Gusts::new(&wind, 0.04));
        assert_ne!(gusts, Gusts::new(&Wind { seed: 2, ..wind }, 0.04));
    }

    #[test]
    fn energy_follows_kolmogorov_spectrum() {
        let wind = Wind { gusts: 0.3, gust_length: 2.0, ..Wind::new(Vec3::X) };
        let gusts = Gusts::new(&wind, 0.01);
        // In equal steps of log k the energy of a wave is k E(k), so a² falls with k^(-2/3).
        let fine: Vec<_> = gusts.modes.iter().filter(|(k, ..)| k.length() > 8.0 / 2.678).collect();
        assert!(fine.len() > 6);
        let (first, last) = (fine[0], fine[fine.len() - 1]);
        let slope = (last.2.length_squared() / first.2.length_squared()).ln()
            / (last.0.length() / first.0.length()).ln();
        assert!((slope + 2.0 / 3.0).abs() < 0.06, "{slope}");
    }

    #[test]
    fn mean_wind_carries_gusts() {
        let gusts = Gusts::new(&Wind::new(Vec3::X * 5.0), 0.04);
        let at = |x: DVec3, corner: DVec3, way: DVec3| -> Vec3 {
            let local = ((x - corner) / 0.04).as_vec3();
            gusts
                .at(corner, way, 1.0, 0.04)
                .iter()
                .map(|m| m.amplitude * (m.wave.dot(local) + m.phase).cos())
                .sum()
        };
        let x = DVec3::new(0.2, 1.5, 0.1);
        let way = DVec3::new(0.7, 0.0, 0.2);
        let before = at(x, DVec3::new(-0.4, 1.0, -0.6), DVec3::ZERO);
        assert!((before - at(x + way, DVec3::new(0.0, 0.9, 0.0), way)).length() < 1e-4);
        assert!((before - at(x, DVec3::new(-0.4, 1.0, -0.6), way)).length() > 1e-2);
    }
}
