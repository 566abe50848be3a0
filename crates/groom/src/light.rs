//! Lights that files bring.

use glam::Vec3;

/// Place and direction of a [`PunctualLight`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub enum PunctualShape {
    /// A light at infinity.
    Directional {
        /// Direction into which it shines, unit.
        direction: Vec3,
    },
    /// A point that emits in all directions.
    Point {
        /// Position, meters.
        position: Vec3,
    },
    /// A point that emits into a cone.
    Spot {
        /// Position, meters.
        position: Vec3,
        /// Direction into which it shines, unit.
        direction: Vec3,
        /// Angle between the axis and the edge of full light, radians.
        inner: f32,
        /// Angle between the axis and the end of the cone, radians; at most π/2.
        outer: f32,
    },
}

/// A light without size, as glTF's `KHR_lights_punctual` describes it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct PunctualLight {
    /// Name of the light or else of its node; may be empty.
    pub name: String,
    /// Place and direction.
    pub shape: PunctualShape,
    /// Color, linear.
    pub color: Vec3,
    /// Illuminance of a directional light (lux), or luminous intensity of other lights (candela).
    pub intensity: f32,
    /// Distance at which the light ends, meters; infinite if the file sets none.
    pub range: f32,
}

#[cfg(any(feature = "cooked", feature = "gltf"))]
impl PunctualLight {
    /// Checks the values.
    ///
    /// # Errors
    /// A clause that names the problem: a number is not finite, a color, intensity or range is negative, or the angles
    /// of the cone are out of order.
    pub(crate) fn check(&self) -> Result<(), String> {
        let problem = |what: &str, value: &dyn std::fmt::Display| Err(format!("{what} is {value}"));
        let is_valid = |value: f32| value.is_finite() && value >= 0.0;
        if !is_valid(self.intensity) {
            return problem("its intensity", &self.intensity);
        }
        if !self.color.to_array().into_iter().all(is_valid) {
            return problem("its color", &self.color);
        }
        if self.range.is_nan() || self.range <= 0.0 {
            return problem("its range", &self.range);
        }
        let (position, direction) = match self.shape {
            PunctualShape::Directional { direction } => (Vec3::ZERO, direction),
            PunctualShape::Point { position } => (position, Vec3::X),
            PunctualShape::Spot { position, direction, inner, outer } => {
                let is_cone = 0.0 <= inner && inner <= outer && outer <= std::f32::consts::FRAC_PI_2;
                if !is_cone {
                    return Err(format!("its cone is from {inner} to {outer} radians"));
                }
                (position, direction)
            }
        };
        if !position.is_finite() {
            return problem("its position", &position);
        }
        if !direction.is_normalized() {
            return Err("its node has no direction".into());
        }
        Ok(())
    }
}
