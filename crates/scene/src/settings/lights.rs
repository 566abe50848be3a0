//! Light settings.

use tresses::{
    glam::Vec3,
    light::{Light, Lights},
};

/// An additional directional light, fixed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Direction it comes from, radians: front (0), the head's left (π/2), back (π).
    pub azimuth: f32,
    /// Elevation above the horizon, radians.
    pub elevation: f32,
    /// Irradiance on a plane that faces the light; 0 is off. The key light has about 5.
    pub irradiance: f32,
}

impl Default for Lamp {
    fn default() -> Self {
        Self { azimuth: 90f32.to_radians(), elevation: 30f32.to_radians(), irradiance: 0.0 }
    }
}

impl Lamp {
    /// Returns the library's light.
    pub fn light(&self) -> Light {
        let (sin, cos) = self.azimuth.sin_cos();
        let (up, level) = self.elevation.sin_cos();
        let direction = Vec3::new(sin * level, up, cos * level);
        Light::distant(direction, Vec3::splat(self.irradiance))
    }
}

/// Settings of all lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSettings {
    /// Strength factor of the key light, which comes from the camera's upper left.
    pub key: f32,
    /// Strength factor of the rim light, which comes from behind.
    pub rim: f32,
    /// Strength factor of the sky light, which comes from all other directions.
    pub sky: f32,
    /// Rotation of key and rim light about the head, radians, toward the head's left.
    pub rotation: f32,
    /// Whether key and rim light follow the camera. Otherwise they stay in place, as for a camera in front of the face.
    pub follow: bool,
    /// Additional lights.
    pub lamps: [Lamp; 2],
    /// Rotation of the environment map about the head, radians, toward the head's left.
    pub environment_rotation: f32,
    /// Strength factor of the environment map.
    pub environment_strength: f32,
    /// Exposure factor, applied to all light before tone mapping.
    pub exposure: f32,
}

impl Default for LightSettings {
    fn default() -> Self {
        Self {
            key: 1.0,
            rim: 1.0,
            sky: 1.0,
            rotation: 0.0,
            follow: true,
            lamps: [Lamp::default(); 2],
            environment_rotation: 0.0,
            environment_strength: 1.0,
            exposure: 1.0,
        }
    }
}

impl LightSettings {
    /// Returns the lights for a camera at `azimuth` around the head, radians, as for [`Lights::around`]. The light of
    /// an environment map, `surroundings`, replaces key, rim and sky light. The caller has already applied
    /// [`environment_rotation`](Self::environment_rotation) and [`environment_strength`](Self::environment_strength) to
    /// it.
    pub fn lights(&self, azimuth: f32, surroundings: Option<&Lights>) -> Lights {
        let mut lights = match surroundings {
            Some(lights) => lights.clone(),
            None => {
                let azimuth = if self.follow { azimuth } else { 0.0 };
                let mut lights = Lights::around(azimuth + self.rotation);
                lights.list[Lights::KEY].color *= self.key;
                lights.list[Lights::RIM].color *= self.rim;
                let sky = &mut lights.sky;
                for radiance in [&mut sky.zenith, &mut sky.horizon, &mut sky.ground] {
                    *radiance *= self.sky;
                }
                lights
            }
        };
        lights.list.extend(self.lamps.iter().filter(|lamp| lamp.irradiance > 0.0).map(Lamp::light));
        lights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_lights_match_the_library() {
        let settings = LightSettings::default();
        assert_eq!(settings.lights(0.7, None), Lights::around(0.7));
        let still = LightSettings { follow: false, rotation: 0.3, ..settings };
        assert_eq!(still.lights(0.7, None), Lights::around(0.3));
        let dark = LightSettings { key: 0.0, ..settings };
        assert_eq!(dark.lights(0.0, None).active().count(), 1);
    }

    #[test]
    fn lamp_azimuth_sets_direction() {
        let left = Lamp { azimuth: 90f32.to_radians(), elevation: 0.0, irradiance: 2.0 };
        let lights = LightSettings { lamps: [left, Lamp::default()], ..Default::default() };
        let lights = lights.lights(1.0, Some(&Lights::around(0.0)));
        let (direction, _) = lights.list[2].irradiance_at(Vec3::ZERO);
        assert!((direction - Vec3::X).length() < 1e-6, "the head's left is +X");
        assert_eq!(lights.active().count(), 3);
    }
}
