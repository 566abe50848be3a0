//! Converts Bevy's lights to the library's: four directional lights and a sky.
//!
//! Hair is a few decimeters large, so light from a point or spot light is nearly parallel there. Each becomes a
//! directional light from its position, with the irradiance that Bevy's shaders compute at the center of the hair,
//! including range and cone. If there are more than four lights, the strongest are used.

use bevy::{camera::visibility::RenderLayers, prelude::*};
use tresses::light::{Directional, Lights, MAX_LIGHTS, Sky};

/// Kind and geometry of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// Distant, with the direction to the light.
    Distant(Vec3),
    /// A point with a range, meters.
    Point { at: Vec3, range: f32 },
    /// A spot along `axis`; the cone attenuation is (`scale` · cos + `offset`)², clamped.
    Spot { at: Vec3, range: f32, axis: Vec3, scale: f32, offset: f32 },
    /// A one-sided rectangle; `right` and `up` are half its edges.
    Rect { at: Vec3, range: f32, right: Vec3, up: Vec3 },
}

/// A light of the scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SceneLight {
    /// Entity in the main world.
    pub entity: Entity,
    pub source: Source,
    /// Color times illuminance (lux) of a distant light, luminance (candela per square meter) of a rectangle, or
    /// luminous intensity (candela) of other lights.
    pub strength: Vec3,
    pub layers: RenderLayers,
    /// Whether hair and meshes cast shadows in its light.
    pub casts: bool,
}

impl SceneLight {
    pub fn directional(
        entity: Entity,
        light: &DirectionalLight,
        transform: &GlobalTransform,
        layers: RenderLayers,
    ) -> Self {
        let strength = rgb(light.color) * light.illuminance;
        let source = Source::Distant(transform.back().into());
        Self { entity, source, strength, layers, casts: light.shadow_maps_enabled }
    }

    pub fn point(
        entity: Entity,
        light: &PointLight,
        transform: &GlobalTransform,
        layers: RenderLayers,
    ) -> Self {
        let source = Source::Point { at: transform.translation(), range: light.range };
        let strength = rgb(light.color) * candela(light.intensity);
        Self { entity, source, strength, layers, casts: light.shadow_maps_enabled }
    }

    pub fn spot(
        entity: Entity,
        light: &SpotLight,
        transform: &GlobalTransform,
        layers: RenderLayers,
    ) -> Self {
        let outer = light.outer_angle.cos();
        let scale = 1.0 / (light.inner_angle.cos() - outer).max(1e-4);
        let source = Source::Spot {
            at: transform.translation(),
            range: light.range,
            axis: transform.forward().into(),
            scale,
            offset: -outer * scale,
        };
        let strength = rgb(light.color) * candela(light.intensity);
        Self { entity, source, strength, layers, casts: light.shadow_maps_enabled }
    }

    pub fn rect(
        entity: Entity,
        light: &RectLight,
        transform: &GlobalTransform,
        layers: RenderLayers,
    ) -> Self {
        let scale = transform.scale();
        let size = Vec2::new(light.width * scale.x, light.height * scale.y).abs().max(Vec2::splat(1e-6));
        let source = Source::Rect {
            at: transform.translation(),
            range: light.range,
            right: 0.5 * size.x * transform.right(),
            up: 0.5 * size.y * transform.up(),
        };
        // Luminance of a diffuse emitter of this size and power.
        let luminance = light.intensity / (size.x * size.y * std::f32::consts::PI);
        // Bevy draws no shadow maps for rectangles.
        Self { entity, source, strength: rgb(light.color) * luminance, layers, casts: false }
    }

    /// Returns the directional light at `position`, scaled by `exposure`.
    fn at(&self, position: Vec3, exposure: f32) -> Directional {
        let (direction, unit_irradiance) = match self.source {
            Source::Distant(direction) => (direction, 1.0),
            Source::Point { at, range } => arriving(at, position, range),
            Source::Spot { at, range, axis, scale, offset } => {
                let (direction, unit_irradiance) = arriving(at, position, range);
                let cone = (scale * axis.dot(-direction) + offset).clamp(0.0, 1.0);
                (direction, unit_irradiance * cone * cone)
            }
            Source::Rect { at, range, right, up } => {
                // Counterclockwise as seen from the front.
                let corners = [right + up, right - up, -right - up, up - right].map(|corner| at + corner);
                let light = Directional::from_polygon(&corners, Vec3::ONE, position);
                (light.direction, light.irradiance.x * left_at(at.distance_squared(position), range))
            }
        };
        Directional { direction, irradiance: self.strength * unit_irradiance * exposure }
    }
}

/// Returns the direction at `position` to a point light at `at`, and the irradiance per intensity: inverse square,
/// clamped below a centimeter (as in Bevy), and fading to zero at `range`.
fn arriving(at: Vec3, position: Vec3, range: f32) -> (Vec3, f32) {
    let light = Directional::from_point(at, Vec3::ONE, position);
    (light.direction, light.irradiance.x * left_at(at.distance_squared(position), range))
}

/// Returns the attenuation by `range` at a squared distance.
fn left_at(square: f32, range: f32) -> f32 {
    let spent = square / (range * range);
    let left = (1.0 - spent * spent).clamp(0.0, 1.0);
    left * left
}

/// Converts the lumens of an isotropic light to candela. Bevy treats spot lights the same way.
fn candela(lumens: f32) -> f32 {
    lumens / (4.0 * std::f32::consts::PI)
}

/// Returns linear RGB.
pub(crate) fn rgb(color: Color) -> Vec3 {
    color.to_linear().to_vec3()
}

/// Returns the light at `position`, scaled by `exposure`: the `lights` in `layers`, and an `ambient` radiance (candela
/// per square meter). Also returns the entities of these lights, and whether hair casts shadows in each.
pub(crate) fn at(
    position: Vec3,
    lights: &[SceneLight],
    layers: &RenderLayers,
    ambient: Vec3,
    exposure: f32,
) -> (Lights, [Option<Entity>; MAX_LIGHTS], [bool; MAX_LIGHTS]) {
    let visible = lights.iter().filter(|light| light.layers.intersects(layers));
    let mut arriving: Vec<_> = visible
        .map(|light| (light.at(position, exposure), light))
        .filter(|(light, _)| light.is_on())
        .collect();
    arriving.sort_by(|(a, _), (b, _)| b.irradiance.element_sum().total_cmp(&a.irradiance.element_sum()));
    let (mut directional, mut entities) = ([Directional::OFF; MAX_LIGHTS], [None; MAX_LIGHTS]);
    let mut casts = [false; MAX_LIGHTS];
    for (i, (light, of)) in arriving.into_iter().take(MAX_LIGHTS).enumerate() {
        (directional[i], entities[i], casts[i]) = (light, Some(of.entity), of.casts);
    }
    let everywhere = ambient * exposure;
    let sky = Sky { zenith: everywhere, horizon: everywhere, ground: everywhere };
    (Lights { directional, sky, environment: Default::default() }, entities, casts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vec3, b: Vec3) -> bool {
        (a - b).length() <= 1e-3 * b.length()
    }

    fn lights_at(lights: &[SceneLight], position: Vec3) -> Vec<Directional> {
        at(position, lights, &RenderLayers::default(), Vec3::ZERO, 1.0).0.active().copied().collect()
    }

    #[test]
    fn point_light_falls_off_and_ends_at_its_range() {
        let light = PointLight { intensity: 4.0 * std::f32::consts::PI * 100.0, range: 1e6, ..default() };
        let lamp = SceneLight::point(
            Entity::PLACEHOLDER,
            &light,
            &GlobalTransform::from_xyz(0.0, 2.0, 0.0),
            default(),
        );
        let [near_by, far] =
            [Vec3::Y, Vec3::NEG_Y * 8.0].map(|position| lights_at(std::slice::from_ref(&lamp), position)[0]);
        assert!(near(near_by.direction, Vec3::Y) && near(near_by.irradiance, Vec3::splat(100.0)));
        assert!(near(far.irradiance, Vec3::ONE), "{}", far.irradiance);
        assert!(!near(far.irradiance, near_by.irradiance), "the comparer sees no difference");
        let short = SceneLight { source: Source::Point { at: Vec3::Y * 2.0, range: 9.0 }, ..lamp };
        assert!(lights_at(&[short], Vec3::NEG_Y * 8.0).is_empty(), "beyond its range");
    }

    #[test]
    fn spot_light_is_limited_to_its_cone() {
        let light = SpotLight { inner_angle: 0.2, outer_angle: 0.4, range: 1e6, ..default() };
        // Above the origin, pointing down.
        let transform = Transform::from_xyz(0.0, 1.0, 0.0).looking_at(Vec3::ZERO, Vec3::Z);
        let spot = [SceneLight::spot(Entity::PLACEHOLDER, &light, &transform.into(), default())];
        let irradiance_at = |angle: f32| {
            let position = Vec3::Y + Quat::from_rotation_x(angle) * Vec3::NEG_Y;
            lights_at(&spot, position).first().map_or(0.0, |light| light.irradiance.x)
        };
        let full = candela(light.intensity);
        assert!(
            (irradiance_at(0.0) / full - 1.0).abs() < 1e-3 && (irradiance_at(0.19) / full - 1.0).abs() < 1e-3
        );
        assert!(
            irradiance_at(0.3) > 0.05 * full && irradiance_at(0.3) < 0.6 * full,
            "{}",
            irradiance_at(0.3) / full
        );
        assert_eq!(irradiance_at(0.41), 0.0);
    }

    #[test]
    fn rectangle_light_is_one_sided() {
        let light = RectLight { intensity: 100.0, width: 0.02, height: 0.03, range: 1e6, ..default() };
        let transform = Transform::from_xyz(0.0, 3.0, 0.0).looking_at(Vec3::ZERO, Vec3::Z);
        let lamp = [SceneLight::rect(Entity::PLACEHOLDER, &light, &transform.into(), default())];
        // From afar a rectangle is a point light of the same power, times the cosine.
        let below = lights_at(&lamp, Vec3::ZERO)[0];
        let power = 100.0 / std::f32::consts::PI;
        assert!(near(below.irradiance, Vec3::splat(power / 9.0)) && near(below.direction, Vec3::Y));
        let oblique = lights_at(&lamp, Vec3::X * 3.0)[0];
        assert!(
            near(oblique.irradiance, Vec3::splat(power / 18.0 * 0.5_f32.sqrt())),
            "{}",
            oblique.irradiance
        );
        assert!(lights_at(&lamp, Vec3::Y * 4.0).is_empty(), "there is no light behind it");
        // An infinite wall gives the irradiance of a sky.
        let wall = RectLight {
            intensity: 4e6 * std::f32::consts::PI,
            width: 2e3,
            height: 2e3,
            range: 1e6,
            ..default()
        };
        let wall = [SceneLight::rect(Entity::PLACEHOLDER, &wall, &transform.into(), default())];
        let found = lights_at(&wall, Vec3::ZERO)[0].irradiance.x;
        assert!((found / std::f32::consts::PI - 1.0).abs() < 0.01, "{found}");
        // A transform of scale 2: four times the area at a quarter of the luminance.
        let double = [SceneLight::rect(
            Entity::PLACEHOLDER,
            &light,
            &transform.with_scale(Vec3::splat(2.0)).into(),
            default(),
        )];
        assert!(near(lights_at(&double, Vec3::ZERO)[0].irradiance, below.irradiance));
    }

    #[test]
    fn four_strongest_lights_in_matching_layers_are_used() {
        let sun = |lux: f32, layer: usize| {
            let light = DirectionalLight { illuminance: lux, ..default() };
            let transform = Transform::default().looking_to(Vec3::NEG_Y, Vec3::Z);
            SceneLight::directional(
                Entity::PLACEHOLDER,
                &light,
                &transform.into(),
                RenderLayers::layer(layer),
            )
        };
        let lights = [sun(1.0, 0), sun(50.0, 1), sun(5.0, 0), sun(3.0, 0), sun(4.0, 0), sun(2.0, 0)];
        let used: Vec<_> = lights_at(&lights, Vec3::ZERO).iter().map(|light| light.irradiance.x).collect();
        assert_eq!(used, [5.0, 4.0, 3.0, 2.0]);
        assert!(
            near(lights_at(&lights, Vec3::ZERO)[0].direction, Vec3::Y),
            "light comes from where it does not go"
        );
        let (dim, ..) = at(Vec3::ZERO, &lights, &default(), Vec3::splat(8.0), 0.5);
        assert_eq!((dim.directional[0].irradiance.x, dim.sky.ground.x), (2.5, 4.0));
    }
}
