//! What a user sets, in SI units, and what the kernels of one step read.

use crate::{Error, Result};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// How dense hair defends its volume.
#[repr(u32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HairHairMode {
    /// Hairs pass through each other; costs nothing.
    Off = 0,
    /// Along the negative gradient of the blurred density, as strongly as the density exceeds what
    /// it is at rest, and friction between hairs.
    #[default]
    Gradient = 1,
    /// For comparison: a push of fixed magnitude out of each cell that is too dense, towards its
    /// least dense neighbour, without blur and without friction, after Bertails, Ménier and Cani
    /// 2005.
    Fixed = 2,
}

/// What hairs do to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairHair {
    /// How dense hair defends its volume.
    pub mode: HairHairMode,
    /// Speed of sound of hair that is pressed together, m/s: the pressure is its square times the
    /// excess of density. What a step cannot follow (a wave farther than `blur` in a step) is cut.
    pub speed: f32,
    /// By how much hair may be denser than at rest before it pushes, as a fraction.
    pub tolerance: f32,
    /// Standard deviation of the density's blur, metres. What the grid itself blurs is counted.
    pub blur: f32,
    /// Rate at which a hair takes on the mean velocity of the hair around it, where that is as
    /// dense as the groom is on average, 1/s.
    pub friction: f32,
    /// The largest acceleration of the push, m/s².
    pub limit: f32,
    /// The magnitude of the push of [`HairHairMode::Fixed`], m/s².
    pub fixed: f32,
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
    };

    /// Checks that every value is finite and in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is not.
    pub fn check(&self) -> Result<()> {
        let test = |name, value, most, range| Error::unless_within(name, value, 0.0, most, range);
        test("hair-hair speed", self.speed, 10.0, "from 0 to 10 m/s")?;
        test("hair-hair tolerance", self.tolerance, 100.0, "from 0 to 100")?;
        test("hair-hair blur", self.blur, 1.0, "from 0 to 1 m")?;
        test("hair-hair friction", self.friction, 1e4, "from 0 to 1e4 1/s")?;
        test("hair-hair limit", self.limit, 1e4, "from 0 to 1e4 m/s²")?;
        test("hair-hair fixed push", self.fixed, 1e4, "from 0 to 1e4 m/s²")
    }
}

/// Uniforms of the volume's kernels in one step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct VolumeUniforms {
    /// Rotation of the head at the begin of the step, quaternion.
    pub head: [f32; 4],
    /// Translation of the head at the begin of the step, metres.
    pub head_at: Vec3,
    /// Cells along an axis.
    pub resolution: u32,
    /// Texture coordinate of the head's origin.
    pub bias: Vec3,
    /// Texture coordinates per metre.
    pub scale: f32,
    /// Velocity of the head's origin, m/s: splatted velocities are relative to it.
    pub drift: Vec3,
    /// Edge of a cell, metres.
    pub cell: f32,
    /// What a cell adds to the running average of the blur, 0 to 1.
    pub gain: f32,
    /// [`HairHairMode`].
    pub mode: u32,
    /// 1 when the rest pose is splatted, to compare with.
    pub resting: u32,
    /// Number of guides.
    pub guide_count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Every how many guides one is splatted.
    pub stride: u32,
    /// How many guides are splatted.
    pub splat_count: u32,
    /// Integer units per metre of hair.
    pub units: f32,
    /// Density per integer unit in a cell, km/m³.
    pub density: f32,
    /// Mean density of the groom, km/m³.
    pub reference: f32,
    /// Square of the speed of sound, m²/s².
    pub speed_squared: f32,
    /// As a fraction.
    pub tolerance: f32,
    /// 1/s.
    pub friction: f32,
    /// m/s².
    pub limit: f32,
    /// m/s².
    pub fixed_push: f32,
    /// The moment of the colliders (see [`crate::collide`]) at which the step begins.
    pub moment: u32,
}

/// The gain of the blur with the variance `variance` (in cells²). The blur averages exponentially,
/// twice forth and twice back; an average with gain `1 - a` has the variance `a / (1 - a)²`.
pub(crate) fn gain(variance: f32) -> f32 {
    if variance <= 1e-6 {
        return 1.0;
    }
    let t = f64::from(variance);
    (1.0 - (t + 2.0 - 2.0 * (t + 1.0).sqrt()) / t) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blur_has_the_variance_that_was_asked_for() {
        for variance in [0.0, 0.2, 0.5, 1.0, 2.4, 6.1, 25.0] {
            let gain = f64::from(gain(variance));
            let mut line = [0f64; 201];
            line[100] = 1.0;
            for _ in 0..2 {
                let (mut first, mut second) = (0.0, 0.0);
                for cell in &mut line {
                    first += gain * (*cell - first);
                    second += gain * (first - second);
                    *cell = second;
                }
                line.reverse();
            }
            let moment = |k: i32| {
                line.iter().zip(-100i32..).map(|(w, i)| w * f64::from(i.pow(2).pow(k as u32))).sum::<f64>()
            };
            let (sum, found) = (moment(0), moment(1));
            assert!(
                (sum - 1.0).abs() < 1e-6 && (found - f64::from(variance)).abs() < 1e-3,
                "{variance}: {sum} {found}"
            );
            let skew: f64 = line.iter().zip(-100i32..).map(|(w, i)| w * f64::from(i)).sum();
            assert!(skew.abs() < 1e-5, "{variance}: {skew}");
        }
    }

    #[test]
    fn wrong_values_are_refused_by_name() {
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
