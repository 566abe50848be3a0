//! User parameters, in SI units, and the uniforms of one step.

use crate::{Result, constants::MAX_TAPS, groom::range, range::Range};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Repulsion of dense hair.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HairHairMode {
    /// No repulsion and no friction; costs nothing.
    Off = 0,
    /// Push along the negative gradient of the blurred excess over the rest density, and friction between hairs.
    #[default]
    Gradient = 1,
    /// For comparison: a push of fixed magnitude out of each cell that is too dense, towards its least dense neighbor,
    /// without blur or friction (Bertails, Ménier and Cani 2005).
    Fixed = 2,
}

/// Parameters of hair–hair interaction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairHair {
    /// Repulsion of dense hair.
    pub mode: HairHairMode,
    /// Speed of sound in compressed hair, m/s: the pressure is its square times the excess density. Limited to `blur`
    /// per step, the fastest wave that a step can follow.
    pub speed: f32,
    /// Excess over the rest density, as a fraction, up to which hair does not push.
    pub tolerance: f32,
    /// Standard deviation of the density's blur, meters, including the blur of the grid itself.
    pub blur: f32,
    /// Rate at which a hair approaches the mean velocity of the surrounding hair, 1/s, at the groom's mean density.
    pub friction: f32,
    /// Largest acceleration of the push, m/s².
    pub limit: f32,
    /// Magnitude of the push of [`HairHairMode::Fixed`], m/s².
    pub fixed: f32,
    /// Stiffness of the links between neighboring guides, as acceleration per distance, 1/s²;
    /// 0 for none.
    pub cohesion: f32,
    /// Largest acceleration by one link, m/s². Beyond it, hair slides along hair.
    pub cohesion_limit: f32,
    /// Distance of linked guide vertices, meters.
    pub cohesion_distance: f32,
}

impl Default for HairHair {
    fn default() -> Self {
        Self {
            mode: HairHairMode::Gradient,
            speed: 0.8,
            tolerance: 0.1,
            blur: 0.018,
            friction: 12.0,
            limit: 50.0,
            fixed: 10.0,
            cohesion: 0.0,
            cohesion_limit: 30.0,
            cohesion_distance: 0.025,
        }
    }
}

impl HairHair {
    /// No hair-hair forces.
    pub const OFF: Self = Self {
        mode: HairHairMode::Off,
        speed: 0.0,
        tolerance: 0.0,
        blur: 0.0,
        friction: 0.0,
        limit: 0.0,
        fixed: 0.0,
        cohesion: 0.0,
        cohesion_limit: 0.0,
        cohesion_distance: 0.025,
    };

    /// The range of [`speed`](Self::speed).
    pub const SPEED: Range = range!("self-collision speed", 0.0 to 10.0, "m/s");
    /// The range of [`tolerance`](Self::tolerance).
    pub const TOLERANCE: Range = range!("self-collision tolerance", 0.0 to 100.0; usually 0.0 to 10.0);
    /// The range of [`blur`](Self::blur).
    pub const BLUR: Range = range!("self-collision blur", 0.0 to 1.0, "m"; usually 0.0 to 0.1);
    /// The range of [`friction`](Self::friction).
    pub const FRICTION: Range = range!("self-collision friction", 0.0 to 1e4, "1/s"; usually 0.0 to 200.0);
    /// The range of [`limit`](Self::limit).
    pub const LIMIT: Range = range!("self-collision limit", 0.0 to 1e4, "m/s²"; usually 0.0 to 1000.0);
    /// The range of [`fixed`](Self::fixed).
    pub const FIXED: Range = range!("self-collision fixed push", 0.0 to 1e4, "m/s²"; usually 0.0 to 1000.0);
    /// The range of [`cohesion`](Self::cohesion).
    pub const COHESION: Range = range!("self-collision cohesion", 0.0 to 1e6, "1/s²"; usually 0.0 to 2000.0);
    /// The range of [`cohesion_limit`](Self::cohesion_limit).
    pub const COHESION_LIMIT: Range =
        range!("self-collision cohesion limit", 0.0 to 1e4, "m/s²"; usually 0.0 to 1000.0);
    /// The range of [`cohesion_distance`](Self::cohesion_distance).
    pub const COHESION_DISTANCE: Range =
        range!("self-collision cohesion reach", 0.001 to 1.0, "m"; usually 0.005 to 0.1);

    /// Checks that every value is finite and in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) names the first invalid value.
    pub fn check(&self) -> Result<()> {
        Self::SPEED.check(self.speed)?;
        Self::TOLERANCE.check(self.tolerance)?;
        Self::BLUR.check(self.blur)?;
        Self::FRICTION.check(self.friction)?;
        Self::LIMIT.check(self.limit)?;
        Self::FIXED.check(self.fixed)?;
        Self::COHESION.check(self.cohesion)?;
        Self::COHESION_LIMIT.check(self.cohesion_limit)?;
        Ok(Self::COHESION_DISTANCE.check(self.cohesion_distance)?)
    }
}

/// Uniforms of the volume's kernels in one step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct VolumeUniforms {
    /// Rotation of the head at the start of the step, quaternion.
    pub head: [f32; 4],
    /// Translation of the head at the start of the step, meters.
    pub head_at: Vec3,
    /// Cells along an axis.
    pub resolution: u32,
    /// Texture coordinate of the head's origin.
    pub bias: Vec3,
    /// Texture coordinates per meter.
    pub scale: f32,
    /// Velocity of the head's origin, m/s: splatted velocities are relative to it.
    pub drift: Vec3,
    /// Edge of a cell, meters.
    pub cell: f32,
    /// Always 1, but unknown to drivers: loops that increment by it are not unrolled.
    pub one: u32,
    /// The [`HairHairMode`].
    pub mode: u32,
    /// 1 to splat the rest pose, for the rest density.
    pub resting: u32,
    /// Number of guides.
    pub guide_count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Stride between splatted guides.
    pub stride: u32,
    /// Number of splatted guides.
    pub splat_count: u32,
    /// Integer units per meter of hair.
    pub units: f32,
    /// Density per integer unit in a cell, km/m³.
    pub density: f32,
    /// Mean density of the groom, km/m³.
    pub reference: f32,
    /// Square of the speed of sound, m²/s².
    pub speed_squared: f32,
    /// Tolerated excess density, as a fraction.
    pub tolerance: f32,
    /// Friction rate, 1/s.
    pub friction: f32,
    /// Largest acceleration of the push, m/s².
    pub limit: f32,
    /// Magnitude of the push in fixed mode, m/s².
    pub fixed_push: f32,
    /// Collider moment (see [`crate::collide`]) at the start of the step.
    pub moment: u32,
    /// Vertices of a guide per sample.
    pub vertices_per_sample: u32,
    /// Samples per guide.
    pub samples: u32,
    /// Unused.
    pub _pad: [u32; 2],
    /// Rotation from the axes of velocities to the axes of the grid's momentum, quaternion; they may differ for another
    /// groom.
    pub velocity_rotation: [f32; 4],
}

/// Weights of the blur along one axis, for four cells in a row.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Blur {
    /// Radius of the blur, cells.
    pub radius: i32,
    /// Number of cells read for four, starting `radius` below the first.
    pub taps: i32,
    /// Unused.
    pub _pad: [u32; 2],
    /// Weights of each cell read, in each of the four.
    pub weights: [[f32; 4]; MAX_TAPS as usize],
}

impl Blur {
    /// Returns the blur with variance `variance` (cells²): the discrete Gaussian `e⁻ᵗ Iₙ(t)` (Lindeberg 1990), which
    /// has variance `t` at any width, truncated at three and a half standard deviations and at 46 cells.
    pub fn new(variance: f32) -> Self {
        let t = f64::from(variance);
        let sigma = t.max(0.0).sqrt();
        let max_radius = (MAX_TAPS as usize - 4) / 2;
        let radius = if t > 1e-3 { ((3.5 * sigma + 0.5).ceil() as usize).min(max_radius) } else { 0 };
        // Bessel functions by Miller's downward recurrence, up to a factor.
        let mut half = vec![0f64; radius + 1];
        let (mut above, mut current) = (0.0, 1e-200);
        for n in (0..=radius + 20 + (6.0 * sigma) as usize).rev() {
            if let Some(w) = half.get_mut(n) {
                *w = current;
            }
            (above, current) = (current, above + 2.0 * n as f64 / t.max(1e-3) * current);
        }
        let sum = half[0] + 2.0 * half[1..].iter().sum::<f64>();
        let mut weights = [[0.0; 4]; MAX_TAPS as usize];
        for (k, row) in weights.iter_mut().enumerate().take(2 * radius + 4) {
            for (c, weight) in row.iter_mut().enumerate() {
                *weight = half.get(k.abs_diff(radius + c)).map_or(0.0, |w| (w / sum) as f32);
            }
        }
        Self { radius: radius as i32, taps: 2 * radius as i32 + 4, _pad: [0; 2], weights }
    }
}

/// Stride between the uniforms of consecutive steps, bytes: a multiple of every adapter's alignment.
pub(super) const STRIDE: u32 = 512;

/// Returns the dynamic offset of the uniforms of step `i`.
pub(crate) fn offset(i: u32) -> u32 {
    i * STRIDE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blur_has_requested_variance() {
        for variance in [0.0, 0.002, 0.2, 0.5, 1.0, 2.4, 6.1, 25.0, 100.0] {
            let blur = Blur::new(variance);
            for c in 0..4 {
                let moment = |k: i32| {
                    let at = |i: usize| f64::from(i as i32 - blur.radius - c).powi(k);
                    let rows = blur.weights.iter().enumerate();
                    rows.map(|(i, row)| f64::from(row[c as usize]) * at(i)).sum::<f64>()
                };
                let (sum, mean, found) = (moment(0), moment(1), moment(2));
                assert!((sum - 1.0).abs() < 1e-6 && mean.abs() < 1e-5, "{variance}: {sum} {mean}");
                assert!(
                    (found - f64::from(variance)).abs() < 0.01 * f64::from(variance) + 1e-6,
                    "{variance}: {found}"
                );
            }
            assert!(blur.weights[blur.taps as usize..].iter().all(|row| *row == [0.0; 4]));
        }
        assert_eq!(Blur::new(1e6).taps, MAX_TAPS as i32);
        assert!(Blur::new(4e6).weights.iter().flatten().all(|w| (0.0..0.1).contains(w)));
    }

    #[test]
    fn invalid_values_return_errors_with_names() {
        HairHair::default().check().unwrap();
        HairHair::OFF.check().unwrap();
        for (params, name) in [
            (HairHair { speed: f32::NAN, ..Default::default() }, "speed"),
            (HairHair { tolerance: -0.1, ..Default::default() }, "tolerance"),
            (HairHair { blur: 2.0, ..Default::default() }, "blur"),
            (HairHair { friction: f32::INFINITY, ..Default::default() }, "friction"),
            (HairHair { limit: -1.0, ..Default::default() }, "limit"),
            (HairHair { fixed: 1e9, ..Default::default() }, "fixed"),
        ] {
            assert!(params.check().unwrap_err().to_string().contains(name));
        }
    }
}
