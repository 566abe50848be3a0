//! Reads Bevy's lights into the library's.

use bevy::{camera::visibility::RenderLayers, prelude::*};
use std::f32::consts::{FRAC_PI_2, PI};
use tresses::{
    Result,
    light::{Light, LightShape, Lights, Sky},
};

/// A light of the scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SceneLight {
    pub light: Light,
    pub layers: RenderLayers,
}

/// A component that is a light.
pub(crate) trait LightComponent: Component {
    /// Returns the light of an entity at `transform`, with the units of [`Light`]: lux, candela, and candela per square
    /// meter.
    fn light(&self, transform: &GlobalTransform) -> Light;
}

impl LightComponent for DirectionalLight {
    fn light(&self, transform: &GlobalTransform) -> Light {
        let shape = LightShape::Distant { direction: axis(transform, Vec3::Z) };
        Light {
            color: rgb(self.color),
            casts_shadows: self.shadow_maps_enabled,
            ..Light::new(shape, self.illuminance)
        }
    }
}

impl LightComponent for PointLight {
    fn light(&self, transform: &GlobalTransform) -> Light {
        let shape = LightShape::Point { position: transform.translation() };
        Light {
            color: rgb(self.color),
            range: self.range,
            casts_shadows: self.shadow_maps_enabled,
            ..Light::new(shape, candela(self.intensity))
        }
    }
}

impl LightComponent for SpotLight {
    fn light(&self, transform: &GlobalTransform) -> Light {
        // Clamped as in Bevy, which warns about it.
        let outer =
            if self.outer_angle >= FRAC_PI_2 { FRAC_PI_2 - MIN_CONE_MARGIN } else { self.outer_angle };
        let shape = LightShape::Spot {
            position: transform.translation(),
            direction: axis(transform, Vec3::NEG_Z),
            inner: self.inner_angle.min(outer),
            outer,
        };
        Light {
            color: rgb(self.color),
            range: self.range,
            casts_shadows: self.shadow_maps_enabled,
            ..Light::new(shape, candela(self.intensity))
        }
    }
}

impl LightComponent for RectLight {
    fn light(&self, transform: &GlobalTransform) -> Light {
        let edge = |axis: Vec3, length: f32| 0.5 * length * transform.affine().transform_vector3(axis);
        // The light shines along -Z. Seen from there, its right edge is on the side of -X.
        let (right, up) = (edge(Vec3::NEG_X, self.width), edge(Vec3::Y, self.height));
        let shape = LightShape::Rectangle { center: transform.translation(), right, up };
        // Radiance of a diffuse emitter of this size and power. It is negative if one edge is.
        let area = 4.0 * right.length() * up.length() * self.width.signum() * self.height.signum();
        Light {
            color: rgb(self.color),
            range: self.range,
            // Bevy draws no shadow maps for rectangles.
            casts_shadows: false,
            ..Light::new(shape, self.intensity / (area * PI))
        }
    }
}

/// Bevy's spot lights are narrower than a half-space by this angle, radians.
const MIN_CONE_MARGIN: f32 = 1e-4;

impl SceneLight {
    /// Reads the light of an `entity`.
    ///
    /// # Errors
    /// [`Light::check`], for components with invalid values.
    pub fn new(
        entity: Entity,
        component: &impl LightComponent,
        transform: &GlobalTransform,
        layers: RenderLayers,
    ) -> Result<Self> {
        let light = component.light(transform).with_id(id(entity));
        light.check()?;
        Ok(Self { light, layers })
    }
}

/// Returns the [`Light::id`] of an entity.
pub(crate) fn id(entity: Entity) -> u32 {
    entity.index_u32()
}

/// Returns the unit vector along an axis of an entity, or zero if its scale is zero.
fn axis(transform: &GlobalTransform, axis: Vec3) -> Vec3 {
    transform.affine().transform_vector3(axis).normalize_or_zero()
}

/// Converts the lumens of an isotropic light to candela. Bevy treats spot lights the same way.
fn candela(lumens: f32) -> f32 {
    lumens / (4.0 * PI)
}

/// Returns linear RGB. Negative channels, of colors outside the gamut of sRGB, become zero.
pub(crate) fn rgb(color: Color) -> Vec3 {
    color.to_linear().to_vec3().map(|channel| if channel < 0.0 { 0.0 } else { channel })
}

/// Returns the lights in `layers` and an `ambient` radiance (candela per square meter), scaled by `exposure`.
pub(crate) fn visible(lights: &[SceneLight], layers: &RenderLayers, ambient: Vec3, exposure: f32) -> Lights {
    let exposed = |light: &Light| Light { intensity: light.intensity * exposure, ..*light };
    let list = lights.iter().filter(|light| light.layers.intersects(layers));
    let everywhere = ambient * exposure;
    Lights {
        list: list.map(|light| exposed(&light.light)).collect(),
        sky: Sky { zenith: everywhere, horizon: everywhere, ground: everywhere },
        environment: Default::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vec3, b: Vec3) -> bool {
        (a - b).length() <= 1e-3 * b.length()
    }

    fn read(component: &impl LightComponent, transform: Transform) -> Light {
        let entity = Entity::from_raw_u32(7).unwrap();
        SceneLight::new(entity, component, &transform.into(), default()).unwrap().light
    }

    /// Two meters above the origin, pointing down.
    fn above() -> Transform {
        Transform::from_xyz(0.0, 2.0, 0.0).looking_at(Vec3::ZERO, Vec3::Z)
    }

    #[test]
    fn units_are_candela_and_lux() {
        let color = Color::linear_rgb(1.0, 0.5, 0.25);
        let sun = DirectionalLight { illuminance: 80.0, color, shadow_maps_enabled: true, ..default() };
        let lumens = 4.0 * PI * 100.0;
        let point = PointLight { intensity: lumens, range: 9.0, color, ..default() };
        let spot = SpotLight { intensity: lumens, inner_angle: 0.2, outer_angle: 0.4, color, ..default() };
        let [sun, point, spot] = [read(&sun, above()), read(&point, above()), read(&spot, above())];
        let rgb = Vec3::new(1.0, 0.5, 0.25);
        for (light, expected) in [(sun, 80.0), (point, 25.0), (spot, 25.0)] {
            // Without the end of its range.
            let (direction, irradiance) = Light { range: 1e6, ..light }.irradiance_at(Vec3::ZERO);
            assert!(near(direction, Vec3::Y) && near(irradiance, expected * rgb), "{direction} {irradiance}");
            assert_eq!(light.id, 7);
        }
        assert_eq!([sun, point, spot].map(|light| light.casts_shadows), [true, false, false]);
        assert_eq!([sun, point, spot].map(|light| light.range), [f32::INFINITY, 9.0, 20.0]);
        let LightShape::Spot { direction, inner, outer, .. } = spot.shape else { panic!("{spot:?}") };
        assert!(near(direction, Vec3::NEG_Y));
        assert_eq!([inner, outer], [0.2, 0.4]);
    }

    #[test]
    fn rectangle_light_shines_along_its_forward_direction() {
        let light = RectLight { intensity: 100.0, width: 0.02, height: 0.03, range: 1e6, ..default() };
        let lamp = read(&light, above());
        // From afar, a rectangle is a point light of the same power, times the cosine.
        let (direction, below) = lamp.irradiance_at(Vec3::ZERO);
        assert!(near(direction, Vec3::Y) && near(below, Vec3::splat(100.0 / PI / 4.0)), "{below}");
        assert_eq!(lamp.irradiance_at(Vec3::Y * 3.0).1, Vec3::ZERO, "there is no light behind it");
        assert!(!lamp.casts_shadows);
        let LightShape::Rectangle { right, up, .. } = lamp.shape else { panic!("{lamp:?}") };
        assert!((right.length() - 0.01).abs() < 1e-6 && (up.length() - 0.015).abs() < 1e-6, "{right} {up}");
        // Twice the scale: four times the area at a quarter of the radiance.
        let double = read(&light, above().with_scale(Vec3::splat(2.0)));
        assert!(near(double.irradiance_at(Vec3::ZERO).1, below));
    }

    #[test]
    fn all_lights_in_matching_layers_are_used() {
        let sun = |lux: f32, layer: usize| {
            let light = DirectionalLight { illuminance: lux, ..default() };
            let layers = RenderLayers::layer(layer);
            SceneLight::new(Entity::PLACEHOLDER, &light, &GlobalTransform::IDENTITY, layers).unwrap()
        };
        let lights = [sun(1.0, 0), sun(50.0, 1), sun(5.0, 0), sun(3.0, 0), sun(4.0, 0), sun(2.0, 0)];
        let found = visible(&lights, &default(), Vec3::splat(8.0), 0.5);
        let strengths: Vec<_> = found.list.iter().map(|light| light.strength().x).collect();
        assert_eq!(strengths, [0.5, 2.5, 1.5, 2.0, 1.0]);
        assert_eq!(found.sky.ground.x, 4.0);
        let (direction, _) = found.list[0].irradiance_at(Vec3::ZERO);
        assert!(near(direction, Vec3::Z), "light comes from where it does not go");
    }

    #[test]
    fn invalid_components_are_errors() {
        fn problem(component: &impl LightComponent) -> String {
            let transform = above().into();
            let light = SceneLight::new(Entity::PLACEHOLDER, component, &transform, default());
            light.err().map_or_else(String::new, |error| error.to_string())
        }
        assert_eq!(problem(&PointLight::default()), "");
        assert_eq!(problem(&PointLight { intensity: 0.0, ..default() }), "");
        for intensity in [-1.0, f32::NAN, f32::INFINITY] {
            assert!(problem(&PointLight { intensity, ..default() }).contains("intensity"));
            assert!(problem(&RectLight { intensity, ..default() }).contains("intensity"));
            assert!(problem(&DirectionalLight { illuminance: intensity, ..default() }).contains("intensity"));
        }
        for range in [0.0, -1.0, f32::NAN] {
            assert!(problem(&PointLight { range, ..default() }).contains("range"), "{range}");
        }
        for width in [0.0, -1.0, f32::NAN] {
            assert!(problem(&RectLight { width, ..default() }).contains("of a light"), "{width}");
        }
        assert!(problem(&SpotLight { outer_angle: f32::NAN, ..default() }).contains("cone"));
        assert!(problem(&SpotLight { inner_angle: -0.1, ..default() }).contains("cone"));
        // Bevy clamps cones, and so do we; an Oklab color may lie outside the gamut.
        for (inner_angle, outer_angle) in [(0.5, 0.2), (0.0, 2.0), (3.0, 3.0)] {
            assert_eq!(problem(&SpotLight { inner_angle, outer_angle, ..default() }), "");
        }
        let color = Color::oklab(0.5, -0.4, 0.1);
        assert!(color.to_linear().red < 0.0);
        assert_eq!(problem(&PointLight { color, ..default() }), "");
    }
}
