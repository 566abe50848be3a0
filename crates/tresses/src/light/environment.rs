//! Image-based lighting from an environment map. Spherical harmonics hold the smooth part; bright regions become
//! distant lights, which cast shadows.

use super::light::Light;
use glam::{Mat3, Quat, Vec3};
use std::f32::consts::{PI, TAU};

/// Radiance from all directions, as real spherical harmonics up to band 2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Environment {
    /// Coefficients of 1, y, z, x, xy, yz, 3z² - 1, xz, x² - y², linear radiance.
    pub coefficients: [Vec3; 9],
}

/// Evaluates the harmonics in a unit direction.
fn basis(d: Vec3) -> [f32; 9] {
    [
        0.282_095,
        0.488_603 * d.y,
        0.488_603 * d.z,
        0.488_603 * d.x,
        1.092_548 * d.x * d.y,
        1.092_548 * d.y * d.z,
        0.315_392 * (3.0 * d.z * d.z - 1.0),
        1.092_548 * d.x * d.z,
        0.546_274 * (d.x * d.x - d.y * d.y),
    ]
}

/// Factor of each harmonic in the cosine-weighted mean over a hemisphere (Ramamoorthi and Hanrahan 2001).
pub(super) const BANDS: [f32; 9] = [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];

/// Cosines of the radius around the brightest pixel that a distant light collects, and of the outer radius of the
/// ring that gives the background of the light: 8 and 16 degrees for suns and lamps, 25 and 40 for windows and bright
/// clouds.
const CONES: [[f32; 2]; 2] = [[0.990_268, 0.961_262], [0.906_308, 0.766_044]];

/// Maximum number of bright regions that become lights.
const MAX_REGIONS: usize = 4;
/// Minimum fraction of all light in a distant light.
const STRONG: f32 = 0.08;

impl Environment {
    /// Creates an environment with the same radiance from everywhere.
    pub fn uniform(radiance: Vec3) -> Self {
        let mut coefficients = [Vec3::ZERO; 9];
        coefficients[0] = radiance / 0.282_095;
        Self { coefficients }
    }

    /// Returns the cosine-weighted mean radiance over the hemisphere around `normal` (unit vector). CPU reference of
    /// `environment::surroundings`, without the sky (Ramamoorthi and Hanrahan 2001).
    pub fn around(&self, normal: Vec3) -> Vec3 {
        let each = basis(normal).into_iter().zip(BANDS).zip(self.coefficients);
        each.map(|((y, band), sum)| sum * y * band).sum::<Vec3>().max(Vec3::ZERO)
    }

    /// Returns the environment after a rotation.
    pub fn rotated(&self, rotation: Quat) -> Self {
        let [constant, y, z, x, xy, yz, zz, xz, squares] = self.coefficients;
        // Band 1 is a vector per color channel, band 2 a symmetric traceless matrix.
        let matrix = Mat3::from_quat(rotation);
        let mut coefficients = [Vec3::ZERO; 9];
        coefficients[0] = constant;
        for color in 0..3 {
            let first = matrix * Vec3::new(x[color], y[color], z[color]);
            let [xy, yz, zz, xz, squares] = [xy, yz, zz, xz, squares].map(|sum| sum[color]);
            let [cross, along, planar] = [0.5 * 1.092_548, 0.315_392, 0.546_274];
            let second = Mat3::from_cols(
                Vec3::new(-along * zz + planar * squares, cross * xy, cross * xz),
                Vec3::new(cross * xy, -along * zz - planar * squares, cross * yz),
                Vec3::new(cross * xz, cross * yz, 2.0 * along * zz),
            );
            let second = matrix * second * matrix.transpose();
            let rotated = [
                first.y,
                first.z,
                first.x,
                second.x_axis.y / cross,
                second.y_axis.z / cross,
                second.z_axis.z / (2.0 * along),
                second.x_axis.z / cross,
                (second.x_axis.x - second.y_axis.y) / (2.0 * planar),
            ];
            coefficients[1..].iter_mut().zip(rotated).for_each(|(sum, new)| sum[color] = new);
        }
        Self { coefficients }
    }

    /// Returns the weighted sum of two environments.
    pub fn blended(&self, weight: f32, other: &Self, other_weight: f32) -> Self {
        let both = |i: usize| weight * self.coefficients[i] + other_weight * other.coefficients[i];
        Self { coefficients: std::array::from_fn(both) }
    }

    /// Converts an equirectangular image of `width` × `height` pixels of linear radiance, in rows from the top left. Up
    /// is at the top, the center lies towards +Z, the left and right edges towards -Z, and +X is left of the center
    /// (looking along +Z). `angle` rotates the environment about the vertical, in radians from +Z towards +X.
    ///
    /// At most four bright regions, of up to 25 degrees around their middle, become distant lights, whose ids are their
    /// indices; their light leaves the harmonics, so the total is conserved. Pixels that are not finite count as black.
    /// Returns `None` when the sizes do not match or are 0.
    pub fn from_equirectangular(
        width: usize,
        height: usize,
        pixels: &[[f32; 3]],
        angle: f32,
    ) -> Option<(Self, Vec<Light>)> {
        if width == 0 || height == 0 || pixels.len() != width.checked_mul(height)? {
            return None;
        }
        let direction = |i: usize| {
            let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            let elevation = PI * (0.5 - y / height as f32);
            let azimuth = angle + TAU * (0.5 - x / width as f32);
            let (sin, cos) = azimuth.sin_cos();
            Vec3::new(sin * elevation.cos(), elevation.sin(), cos * elevation.cos())
        };
        let area = |i: usize| {
            let edge = |y: usize| (PI * y as f32 / height as f32).cos();
            let y = i / width;
            (edge(y) - edge(y + 1)) * TAU / width as f32
        };
        let radiance = |p: &[f32; 3]| {
            let v = Vec3::from(*p).max(Vec3::ZERO);
            if v.is_finite() { v } else { Vec3::ZERO }
        };
        let mut left: Vec<Vec3> = pixels.iter().map(radiance).collect();
        let total: f32 = left.iter().enumerate().map(|(i, v)| v.element_sum() * area(i)).sum();
        let mut lights = Vec::new();
        let mut cones = CONES.iter();
        let mut cone = cones.next();
        while let Some([inner, outer]) = cone.filter(|_| lights.len() < MAX_REGIONS) {
            let brightest =
                (0..left.len()).max_by(|a, b| left[*a].element_sum().total_cmp(&left[*b].element_sum()))?;
            // The brightest pixel may lie at the edge of a light.
            let near = (0..left.len()).filter(|i| direction(*i).dot(direction(brightest)) > *inner);
            let center = near.map(|i| direction(i) * (left[i].element_sum() * area(i))).sum::<Vec3>();
            let center = center.normalize_or(direction(brightest));
            let towards = |i: usize| direction(i).dot(center);
            let inside: Vec<usize> = (0..left.len()).filter(|i| towards(*i) > *inner).collect();
            // The background continues behind the light.
            let around = (0..left.len()).filter(|i| (*outer..=*inner).contains(&towards(*i)));
            let mut ring: Vec<f32> = around.map(|i| left[i].element_sum()).collect();
            ring.sort_by(f32::total_cmp);
            // The ring is empty in very coarse images, where no light stands out.
            let Some(common) = ring.get(ring.len() / 2).copied() else {
                cone = cones.next();
                continue;
            };
            let (mut sum, mut to) = (Vec3::ZERO, Vec3::ZERO);
            let mut rest = left.clone();
            for i in inside {
                let bright = left[i].element_sum();
                let excess = left[i] * (1.0 - (common / bright.max(1e-20)).min(1.0));
                sum += excess * area(i);
                to += direction(i) * (excess.element_sum() * area(i));
                rest[i] -= excess;
            }
            if sum.element_sum() <= STRONG * total {
                cone = cones.next();
                continue;
            }
            left = rest;
            let light = Light::distant(to.normalize_or(center), sum);
            lights.push(light.with_id(lights.len() as u32));
        }
        let mut environment = Self::default();
        for (i, v) in left.iter().enumerate() {
            let weight = *v * area(i);
            for (sum, y) in environment.coefficients.iter_mut().zip(basis(direction(i))) {
                *sum += weight * y;
            }
        }
        Some((environment, lights))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(light: &Light) -> Vec3 {
        light.irradiance_at(Vec3::ZERO).0
    }

    fn picture(f: impl Fn(f32, f32) -> f32) -> Vec<[f32; 3]> {
        (0..64 * 128).map(|i| [f((i % 128) as f32 + 0.5, (i / 128) as f32 + 0.5); 3]).collect()
    }

    #[test]
    fn uniform_map_gives_uniform_environment() {
        let (made, lights) = Environment::from_equirectangular(128, 64, &picture(|_, _| 0.25), 0.4).unwrap();
        assert!(lights.is_empty());
        for normal in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, -0.8)] {
            assert!((made.around(normal) - 0.25).abs().max_element() < 1e-3);
            assert!((Environment::uniform(Vec3::splat(0.25)).around(normal) - 0.25).length() < 1e-5);
        }
    }

    #[test]
    fn rotation_moves_radiance_with_direction() {
        let coefficients = std::array::from_fn(|i| Vec3::new(2.0 - i as f32, (i as f32).sin(), 0.3));
        let environment = Environment { coefficients };
        let raw = |of: &Environment, d: Vec3| -> Vec3 {
            basis(d).into_iter().zip(of.coefficients).map(|(y, sum)| y * sum).sum()
        };
        let rotation = Quat::from_euler(glam::EulerRot::YXZ, 0.7, -1.1, 2.3);
        let turned = environment.rotated(rotation);
        for d in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.48, 0.6, -0.64), Vec3::new(-0.36, 0.48, 0.8)] {
            let off = raw(&turned, rotation * d) - raw(&environment, d);
            assert!(off.abs().max_element() < 1e-5, "{off}");
            assert!(
                (raw(&turned, d) - raw(&environment, d)).length() > 0.1,
                "the comparer sees no difference"
            );
        }
        let both = environment.blended(0.5, &turned, 2.0);
        assert!(
            (raw(&both, Vec3::X) - 0.5 * raw(&environment, Vec3::X) - 2.0 * raw(&turned, Vec3::X)).length()
                < 1e-5
        );
    }

    #[test]
    fn map_orientation_follows_the_axes() {
        // White above; then white left of the center, towards +X.
        let (above, _) =
            Environment::from_equirectangular(128, 64, &picture(|_, y| f32::from(y < 32.0)), 0.0).unwrap();
        assert!(above.around(Vec3::Y).x > 0.9 && above.around(Vec3::NEG_Y).x < 0.1);
        // A vertical plane sees half of it.
        assert!((above.around(Vec3::Z).x - 0.5).abs() < 0.01);
        let left = picture(|x, _| f32::from(x < 64.0));
        let (left, _) = Environment::from_equirectangular(128, 64, &left, 0.0).unwrap();
        assert!(left.around(Vec3::X).x > 0.9 && left.around(Vec3::NEG_X).x < 0.1);
        // A quarter turn from +Z towards +X moves +X to -Z.
        let left = picture(|x, _| f32::from(x < 64.0));
        let (turned, _) = Environment::from_equirectangular(128, 64, &left, 0.5 * PI).unwrap();
        assert!(turned.around(Vec3::NEG_Z).x > 0.9);
    }

    #[test]
    fn sun_becomes_a_light_and_energy_is_conserved() {
        let sun = |x: f32, y: f32| if (x - 40.0).abs() < 2.0 && (y - 20.0).abs() < 2.0 { 500.0 } else { 0.3 };
        let (rest, lights) = Environment::from_equirectangular(128, 64, &picture(sun), 0.0).unwrap();
        assert_eq!(lights.len(), 1);
        let elevation = PI * (0.5 - 20.0 / 64.0);
        let azimuth = TAU * (0.5 - 40.0 / 128.0);
        let to = Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
        assert!(direction(&lights[0]).dot(to) > 0.9995, "{}", direction(&lights[0]));
        // 16 pixels of (π/64)² cos(elevation).
        let flux = 499.7 * 16.0 * (PI / 64.0).powi(2) * elevation.cos();
        assert!((lights[0].strength().x / flux - 1.0).abs() < 0.02, "{}", lights[0].strength().x / flux);
        assert!((rest.around(Vec3::Y).x - 0.3).abs() < 2e-3);
    }

    #[test]
    fn wide_window_becomes_a_light_but_a_bright_half_does_not() {
        let to = Vec3::new(-0.6, 0.48, 0.64);
        let window = |x: f32, y: f32| {
            let (elevation, azimuth) = (PI * (0.5 - y / 64.0), TAU * (0.5 - x / 128.0));
            let (sin, cos) = azimuth.sin_cos();
            let at = Vec3::new(sin * elevation.cos(), elevation.sin(), cos * elevation.cos());
            0.2 + 4.0 * (9.0 * (at.dot(to) - 1.0)).exp()
        };
        let (rest, lights) = Environment::from_equirectangular(128, 64, &picture(window), 0.0).unwrap();
        assert_eq!(lights.len(), 1);
        assert!(direction(&lights[0]).dot(to) > 0.99, "{}", direction(&lights[0]));
        // All light of the lobe is 2 π 4 / 9.
        let share = lights[0].strength().x / (TAU * 4.0 / 9.0);
        assert!((0.3..0.8).contains(&share), "{share}");
        let whole = rest.around(to).x * PI + lights[0].strength().x;
        assert!((whole / (0.2 * PI + 0.9 * TAU * 4.0 / 9.0) - 1.0).abs() < 0.05, "{whole}");
        let (_, none) =
            Environment::from_equirectangular(128, 64, &picture(|_, y| f32::from(y < 32.0)), 0.0).unwrap();
        assert!(none.is_empty(), "{none:?}");
    }

    #[test]
    fn invalid_maps_are_rejected() {
        assert!(Environment::from_equirectangular(0, 4, &[], 0.0).is_none());
        assert!(Environment::from_equirectangular(4, 4, &[[0.0; 3]; 15], 0.0).is_none());
        let (black, lights) = Environment::from_equirectangular(2, 2, &[[f32::NAN; 3]; 4], 0.0).unwrap();
        assert!(lights.is_empty() && black.around(Vec3::Y) == Vec3::ZERO);
    }
}
