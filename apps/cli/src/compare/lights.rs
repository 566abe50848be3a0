//! Lights of the description. Positions and sizes are in the groom's unit, as those of cameras.

use serde::{Deserialize, Deserializer, de::Error as _};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use tresses::{
    glam::Vec3,
    light::{Light, LightShape},
};

/// A light by its `kind`. Without one, it is distant.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum LightDescription {
    /// Parallel rays.
    Distant {
        /// Direction to the light, unit length.
        direction_to_light: [f32; 3],
        /// Irradiance on a plane that faces the light, linear.
        irradiance_rgb: [f32; 3],
    },
    /// A point.
    Point {
        /// Position.
        position: [f32; 3],
        /// Irradiance at a distance of one unit on a plane that faces the light, linear.
        intensity_rgb: [f32; 3],
    },
    /// A point that emits into a cone, with the falloff of `KHR_lights_punctual`.
    Spot {
        /// Position.
        position: [f32; 3],
        /// Direction into which it shines, unit length.
        direction: [f32; 3],
        /// Angle between the axis and the edge of full light, degrees.
        inner_degrees: f32,
        /// Angle between the axis and the end of the cone, degrees.
        outer_degrees: f32,
        /// Irradiance on the axis at a distance of one unit, linear.
        intensity_rgb: [f32; 3],
    },
    /// A rectangle that emits from the side of `right` × `up`.
    Rectangle {
        /// Center.
        center: [f32; 3],
        /// Half of the horizontal edge.
        right: [f32; 3],
        /// Half of the vertical edge.
        up: [f32; 3],
        /// Radiance, linear.
        radiance_rgb: [f32; 3],
    },
    /// A disc or a ring that emits from one side.
    Disc {
        /// Center.
        center: [f32; 3],
        /// Direction into which it shines, unit length.
        direction: [f32; 3],
        /// Radius.
        radius: f32,
        /// Radius of the hole.
        #[serde(default)]
        hole: f32,
        /// Radiance, linear.
        radiance_rgb: [f32; 3],
    },
    /// A sphere.
    Sphere {
        /// Center.
        center: [f32; 3],
        /// Radius.
        radius: f32,
        /// Radiance, linear.
        radiance_rgb: [f32; 3],
    },
    /// A cylinder without caps.
    Tube {
        /// Both ends of the axis.
        ends: [[f32; 3]; 2],
        /// Radius.
        radius: f32,
        /// Radiance, linear.
        radiance_rgb: [f32; 3],
    },
}

impl LightDescription {
    /// Returns the light in meters, in a groom whose unit is `unit` meters.
    pub fn light(&self, unit: f32) -> Light {
        let meters = |vector: [f32; 3]| Vec3::from(vector) * unit;
        // The same irradiance at the same place: intensity is irradiance times the square of a distance.
        let candela = |intensity: [f32; 3]| Vec3::from(intensity) * (unit * unit);
        match *self {
            Self::Distant { direction_to_light, irradiance_rgb } => {
                Light::distant(direction_to_light.into(), irradiance_rgb.into())
            }
            Self::Point { position, intensity_rgb } => Light::point(meters(position), candela(intensity_rgb)),
            Self::Spot { position, direction, inner_degrees, outer_degrees, intensity_rgb } => {
                let shape = LightShape::Spot {
                    position: meters(position),
                    direction: direction.into(),
                    inner: inner_degrees.to_radians(),
                    outer: outer_degrees.to_radians(),
                };
                Light { color: candela(intensity_rgb), ..Light::new(shape, 1.0) }
            }
            Self::Rectangle { center, right, up, radiance_rgb } => {
                let shape =
                    LightShape::Rectangle { center: meters(center), right: meters(right), up: meters(up) };
                Light::area(shape, radiance_rgb.into())
            }
            Self::Disc { center, direction, radius, hole, radiance_rgb } => {
                let shape = LightShape::Disc {
                    center: meters(center),
                    direction: direction.into(),
                    radius: radius * unit,
                    hole: hole * unit,
                };
                Light::area(shape, radiance_rgb.into())
            }
            Self::Sphere { center, radius, radiance_rgb } => {
                let shape = LightShape::Sphere { center: meters(center), radius: radius * unit };
                Light::area(shape, radiance_rgb.into())
            }
            Self::Tube { ends, radius, radiance_rgb } => {
                let shape = LightShape::Tube { ends: ends.map(meters), radius: radius * unit };
                Light::area(shape, radiance_rgb.into())
            }
        }
    }
}

/// Reads lights by name.
pub fn read<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, LightDescription>, D::Error> {
    let lights = BTreeMap::<String, Map<String, Value>>::deserialize(deserializer)?;
    let read = |(name, mut fields): (String, Map<String, Value>)| {
        fields.entry("kind").or_insert_with(|| "distant".into());
        match serde_json::from_value(fields.into()) {
            Ok(light) => Ok((name, light)),
            Err(error) => Err(D::Error::custom(format!("light {name}: {error}"))),
        }
    };
    lights.into_iter().map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn lights(value: Value) -> Result<BTreeMap<String, LightDescription>, String> {
        read(value).map_err(|error| error.to_string())
    }

    fn light(value: Value) -> LightDescription {
        lights(json!({ "a": value })).unwrap().remove("a").unwrap()
    }

    #[test]
    fn lights_without_a_kind_are_distant() {
        let old = json!({
            "direction_of_travel": [0, -1, 0], "direction_to_light": [0, 1, 0], "irradiance_rgb": [5, 4, 3],
        });
        // Directions and irradiance have no length.
        let expected = Light::distant(Vec3::Y, Vec3::new(5.0, 4.0, 3.0));
        assert_eq!(light(old).light(0.01), expected);
    }

    #[test]
    fn each_kind_of_light_is_read() {
        let rgb = json!([3, 2, 1]);
        let color = Vec3::new(3.0, 2.0, 1.0);
        let cases = [
            (
                json!({ "kind": "point", "position": [1, 2, 3], "intensity_rgb": rgb }),
                Light::point(Vec3::new(1.0, 2.0, 3.0), color),
            ),
            (
                json!({
                    "kind": "spot", "position": [1, 2, 3], "direction": [0, 0, -1], "inner_degrees": 30,
                    "outer_degrees": 60, "intensity_rgb": rgb,
                }),
                Light::area(
                    LightShape::Spot {
                        position: Vec3::new(1.0, 2.0, 3.0),
                        direction: Vec3::NEG_Z,
                        inner: std::f32::consts::FRAC_PI_6,
                        outer: std::f32::consts::FRAC_PI_3,
                    },
                    color,
                ),
            ),
            (
                json!({
                    "kind": "rectangle", "center": [1, 2, 3], "right": [0.5, 0, 0], "up": [0, 0.25, 0],
                    "radiance_rgb": rgb,
                }),
                Light::area(
                    LightShape::Rectangle {
                        center: Vec3::new(1.0, 2.0, 3.0),
                        right: 0.5 * Vec3::X,
                        up: 0.25 * Vec3::Y,
                    },
                    color,
                ),
            ),
            (
                json!({ "kind": "disc", "center": [1, 2, 3], "direction": [0, 0, 1], "radius": 2, "hole": 1, "radiance_rgb": rgb }),
                Light::area(
                    LightShape::Disc {
                        center: Vec3::new(1.0, 2.0, 3.0),
                        direction: Vec3::Z,
                        radius: 2.0,
                        hole: 1.0,
                    },
                    color,
                ),
            ),
            (
                json!({ "kind": "sphere", "center": [1, 2, 3], "radius": 0.5, "radiance_rgb": rgb }),
                Light::area(LightShape::Sphere { center: Vec3::new(1.0, 2.0, 3.0), radius: 0.5 }, color),
            ),
            (
                json!({ "kind": "tube", "ends": [[0, 0, 0], [0, 1, 0]], "radius": 0.25, "radiance_rgb": rgb }),
                Light::area(LightShape::Tube { ends: [Vec3::ZERO, Vec3::Y], radius: 0.25 }, color),
            ),
        ];
        for (value, expected) in cases {
            assert_eq!(light(value).light(1.0), expected);
        }
    }

    /// The description in centimeters gives the same light as the one in meters.
    #[test]
    fn irradiance_is_independent_of_the_unit() {
        let cases = [
            [1.0, 100.0].map(|s| json!({ "kind": "point", "position": [s, 0, 0], "intensity_rgb": [s * s, s * s, s * s] })),
            [1.0, 100.0].map(|s| {
                json!({
                    "kind": "spot", "position": [s, 0, 0], "direction": [-1, 0, 0], "inner_degrees": 5,
                    "outer_degrees": 9, "intensity_rgb": [s * s, s * s, s * s],
                })
            }),
            [1.0, 100.0].map(|s| {
                json!({
                    "kind": "rectangle", "center": [s, 0, 0], "right": [0, 0, -0.3 * s], "up": [0, -0.3 * s, 0],
                    "radiance_rgb": [2, 2, 2],
                })
            }),
            [1.0, 100.0].map(|s| {
                json!({
                    "kind": "disc", "center": [s, 0, 0], "direction": [-1, 0, 0], "radius": 0.2 * s, "hole": 0.1 * s,
                    "radiance_rgb": [2, 2, 2],
                })
            }),
            [1.0, 100.0].map(|s| {
                json!({ "kind": "sphere", "center": [s, 0, 0], "radius": 0.1 * s, "radiance_rgb": [2, 2, 2] })
            }),
            [1.0, 100.0].map(|s| {
                json!({
                    "kind": "tube", "ends": [[s, -s, 0], [s, s, 0]], "radius": 0.01 * s, "radiance_rgb": [2, 2, 2],
                })
            }),
        ];
        for [meters, centimeters] in cases {
            let at = Vec3::new(0.02, -0.01, 0.03);
            let expected = light(meters.clone()).light(1.0).irradiance_at(at).1.x;
            let found = light(centimeters).light(0.01).irradiance_at(at).1.x;
            assert!(expected > 0.0 && (found / expected - 1.0).abs() < 1e-4, "{meters}: {found} {expected}");
        }
    }

    #[test]
    fn invalid_lights_are_named() {
        let found =
            lights(json!({ "lamp": { "kind": "sphere", "center": [0, 0, 0], "radiance_rgb": [1, 1, 1] } }));
        assert_eq!(found.unwrap_err(), "light lamp: missing field `radius`");
        let found = lights(json!({ "lamp": { "kind": "candle" } })).unwrap_err();
        assert!(found.contains("light lamp: unknown variant `candle`"), "{found}");
    }
}
