//! Light settings.

use super::LightEntry;
use tresses::light::{Light, Lights};

/// Settings of all lights.
#[derive(Clone, Debug, PartialEq)]
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
    /// Additional lights, fixed in the world.
    pub list: Vec<LightEntry>,
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
            list: Vec::new(),
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
    /// it. `imported` are lights of other origin, such as those of a character's file.
    ///
    /// The id of each light is unique, and does not change when others are turned off.
    pub fn lights(&self, azimuth: f32, surroundings: Option<&Lights>, imported: &[Light]) -> Lights {
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
        let own = lights.list.len();
        lights.list.extend(self.list.iter().map(|entry| entry.light(0)));
        lights.list.extend(imported);
        for (id, light) in lights.list.iter_mut().enumerate() {
            light.id = id as u32;
        }
        // Key, rim and the environment's lights keep their indices.
        let mut index = 0;
        lights.list.retain(|light| {
            index += 1;
            index <= own || light.is_on()
        });
        lights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::LightKind;
    use tresses::glam::Vec3;

    #[test]
    fn default_lights_match_the_library() {
        let settings = LightSettings::default();
        assert_eq!(settings.lights(0.7, None, &[]), Lights::around(0.7));
        let still = LightSettings { follow: false, rotation: 0.3, ..settings.clone() };
        assert_eq!(still.lights(0.7, None, &[]), Lights::around(0.3));
        let dark = LightSettings { key: 0.0, ..settings };
        let dark = dark.lights(0.0, None, &[]);
        assert_eq!((dark.active().count(), dark.list.len()), (1, 2));
    }

    #[test]
    fn list_and_imported_lights_follow_with_stable_ids() {
        let entry = |kind| LightEntry { position: Vec3::Z, ..LightEntry::new(kind) };
        let mut settings = LightSettings {
            list: [LightKind::Point, LightKind::Spot, LightKind::Sphere].map(entry).into(),
            ..Default::default()
        };
        let imported = [Light::point(Vec3::Y, Vec3::ONE).with_id(1)];
        let ids = |settings: &LightSettings, surroundings: Option<&Lights>| {
            let lights = settings.lights(0.0, surroundings, &imported);
            lights.list.iter().map(|light| light.id).collect::<Vec<_>>()
        };
        assert_eq!(ids(&settings, None), [0, 1, 2, 3, 4, 5]);
        settings.list[1].is_on = false;
        settings.key = 0.0;
        assert_eq!(ids(&settings, None), [0, 1, 2, 4, 5], "a light that is off leaves the list");
        let map = Lights { list: Vec::new(), ..Lights::default() };
        assert_eq!(ids(&settings, Some(&map)), [0, 2, 3], "they add to an environment map");
        let lights = settings.lights(0.0, Some(&map), &imported);
        assert_eq!(lights.list[2].shape, imported[0].shape);
    }
}
