//! Where light comes from.

use tresses::{
    glam::Vec3,
    light::{Directional, Lights},
};

/// Another light from afar, which stays where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Where it comes from, radians: from the front (0) over the head's left to the back (π).
    pub azimuth: f32,
    /// Above the horizon, radians.
    pub elevation: f32,
    /// Irradiance on a plane that faces it, where the key light has about 5; 0 is off.
    pub irradiance: f32,
}

impl Default for Lamp {
    fn default() -> Self {
        Self { azimuth: 90f32.to_radians(), elevation: 30f32.to_radians(), irradiance: 0.0 }
    }
}

impl Lamp {
    /// As the library has it.
    pub fn directional(&self) -> Directional {
        let (sin, cos) = self.azimuth.sin_cos();
        let (up, level) = self.elevation.sin_cos();
        let direction = Vec3::new(sin * level, up, cos * level);
        Directional { direction, irradiance: Vec3::splat(self.irradiance) }
    }
}

/// All light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSettings {
    /// Factor of the main light, which comes from the camera's upper left.
    pub key: f32,
    /// Factor of the light from behind.
    pub rim: f32,
    /// Factor of the light from everywhere else.
    pub sky: f32,
    /// By how much key and rim are turned about the head, radians, towards the head's left.
    pub turn: f32,
    /// Whether key and rim go with the camera; else they stay as for a camera before the face.
    pub follow: bool,
    /// Two more.
    pub lamps: [Lamp; 2],
    /// By how much a picture of the surroundings is turned, radians, towards the head's left.
    pub environment_turn: f32,
    /// What the light of such a picture is multiplied by.
    pub environment_strength: f32,
    /// Factor of all light before the picture is tone mapped.
    pub exposure: f32,
}

impl Default for LightSettings {
    fn default() -> Self {
        Self {
            key: 1.0,
            rim: 1.0,
            sky: 1.0,
            turn: 0.0,
            follow: true,
            lamps: [Lamp::default(); 2],
            environment_turn: 0.0,
            environment_strength: 1.0,
            exposure: 1.0,
        }
    }
}

impl LightSettings {
    /// The lights for a camera that has turned by `azimuth` about the head (radians, as for
    /// [`Lights::around`]). The light of `surroundings`, read with [`environment_turn`](Self::environment_turn)
    /// and multiplied by [`environment_strength`](Self::environment_strength), takes the place of key,
    /// rim and sky.
    pub fn lights(&self, azimuth: f32, surroundings: Option<&Lights>) -> Lights {
        let mut lights = match surroundings {
            Some(lights) => *lights,
            None => {
                let azimuth = if self.follow { azimuth } else { 0.0 };
                let mut lights = Lights::around(azimuth + self.turn);
                lights.directional[Lights::KEY].irradiance *= self.key;
                lights.directional[Lights::RIM].irradiance *= self.rim;
                let sky = &mut lights.sky;
                for radiance in [&mut sky.zenith, &mut sky.horizon, &mut sky.ground] {
                    *radiance *= self.sky;
                }
                lights
            }
        };
        for (place, lamp) in lights.directional[2..].iter_mut().zip(&self.lamps) {
            // The surroundings may have lit it already.
            if lamp.irradiance > 0.0 {
                *place = lamp.directional();
            }
        }
        lights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_a_photographers_lights() {
        let settings = LightSettings::default();
        assert_eq!(settings.lights(0.7, None), Lights::around(0.7));
        let still = LightSettings { follow: false, turn: 0.3, ..settings };
        assert_eq!(still.lights(0.7, None), Lights::around(0.3));
        let dark = LightSettings { key: 0.0, ..settings };
        assert_eq!(dark.lights(0.0, None).active().count(), 1);
    }

    #[test]
    fn lamps_stand_where_they_say() {
        let left = Lamp { azimuth: 90f32.to_radians(), elevation: 0.0, irradiance: 2.0 };
        let lights = LightSettings { lamps: [left, Lamp::default()], ..Default::default() };
        let lights = lights.lights(1.0, Some(&Lights::around(0.0)));
        assert!((lights.directional[2].direction - Vec3::X).length() < 1e-6, "the head's left is +X");
        assert_eq!(lights.active().count(), 3);
    }
}
