//! Lights and shadows of `tresses render`.

use anyhow::{Result, ensure};
use std::str::FromStr;
use tresses::light::ShadowMethod;
use tresses_scene::{Settings, settings::Lamp};

/// How hair is counted in shadows.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Hair is solid: soft edges, black behind the first row
    Opaque,
    /// Hair takes light in proportion to the way behind the hair nearest the light
    Absorption,
    /// Fibres are counted where they are, in layers behind the hair's front
    Deep,
    /// No shadows at all
    Off,
}

impl Method {
    /// The library's.
    pub fn method(self) -> ShadowMethod {
        match self {
            Self::Opaque => ShadowMethod::Opaque,
            Self::Absorption => ShadowMethod::Absorption,
            Self::Deep => ShadowMethod::DeepOpacity,
            Self::Off => ShadowMethod::Off,
        }
    }
}

/// Shadows.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct ShadowArgs {
    /// How hair shadows hair, head and body [default: deep]
    #[arg(long, value_name = "METHOD", value_enum, help_heading = "Shadows")]
    shadows: Option<Method>,
    /// Texels along each edge of a shadow map, 64 to 2048 [default: 1024]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..=2048), help_heading = "Shadows")]
    shadow_resolution: Option<u32>,
    /// Radius over which shadows on hair are averaged, millimetres [default: 3]
    #[arg(long, value_name = "MM", value_parser = softness, help_heading = "Shadows")]
    shadow_softness: Option<f32>,
    /// Shade hair, and look its shadows up, for every pixel, not only at the vertices of its strands
    #[arg(long, help_heading = "Shadows")]
    shadows_per_pixel: bool,
    /// Another light, at most two: where from, degrees from the front over the head's left and degrees above the horizon, and how strong, where the main light is 5
    #[arg(
        long = "light",
        value_name = "AZIMUTH,ELEVATION[,IRRADIANCE]",
        allow_hyphen_values = true,
        help_heading = "Shadows"
    )]
    lights: Vec<Light>,
}

/// A light from afar.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Light(Lamp);

impl FromStr for Light {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let numbers: std::result::Result<Vec<f32>, _> =
            text.split(',').map(|part| part.trim().parse()).collect();
        let (azimuth, elevation, irradiance) = match numbers.as_deref() {
            Ok([azimuth, elevation]) => (*azimuth, *elevation, 2.0),
            Ok([azimuth, elevation, irradiance]) => (*azimuth, *elevation, *irradiance),
            _ => return Err("give azimuth,elevation as in 90,30, and a strength if you like".into()),
        };
        if azimuth.abs() > 360.0 || elevation.abs() > 90.0 || !(0.0..=100.0).contains(&irradiance) {
            return Err("azimuths go to 360 degrees, elevations to 90, strengths from 0 to 100".into());
        }
        Ok(Self(Lamp { azimuth: azimuth.to_radians(), elevation: elevation.to_radians(), irradiance }))
    }
}

impl ShadowArgs {
    /// Puts what is given into `settings`.
    pub fn apply(&self, settings: &mut Settings) -> Result<()> {
        ensure!(
            self.lights.len() <= 2,
            "--light was given {} times, but at most 2 are possible",
            self.lights.len()
        );
        if !self.lights.is_empty() {
            settings.lights.lamps = Default::default();
            for (lamp, light) in settings.lights.lamps.iter_mut().zip(&self.lights) {
                *lamp = light.0;
            }
        }
        let shadows = &mut settings.shadows;
        shadows.method = self.shadows.map_or(shadows.method, Method::method);
        shadows.hair_radius = self.shadow_softness.map_or(shadows.hair_radius, |mm| 1e-3 * mm);
        shadows.per_pixel |= self.shadows_per_pixel;
        settings.shadow_resolution = self.shadow_resolution.unwrap_or(settings.shadow_resolution);
        Ok(())
    }
}

fn softness(text: &str) -> std::result::Result<f32, String> {
    match text.parse() {
        Ok(value) if (0.1..=50.0).contains(&value) => Ok(value),
        _ => Err("give millimetres from 0.1 to 50".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        shadows: ShadowArgs,
    }

    #[test]
    fn options_reach_the_library() {
        let parse = |line: &str| -> Result<Settings> {
            let mut settings = Settings::default();
            Command::try_parse_from(line.split(' '))?.shadows.apply(&mut settings)?;
            Ok(settings)
        };
        assert_eq!(parse("x").unwrap(), Settings::default());
        let line = "x --shadows opaque --shadow-resolution 512 --shadow-softness 5 --shadows-per-pixel --light 90,0,4";
        let other = parse(line).unwrap();
        assert_eq!(other.shadow_resolution, 512);
        assert_eq!(other.shadows.method, ShadowMethod::Opaque);
        assert!((other.shadows.hair_radius - 0.005).abs() < 1e-6 && other.shadows.per_pixel);
        assert_eq!((other.lights.lamps[0].irradiance, other.lights.lamps[1].irradiance), (4.0, 0.0));
        assert!(parse("x --light 1,2 --light 1,2 --light 1,2").is_err());
        for line in
            ["--shadows soft", "--shadow-resolution 9000", "--shadow-softness 0", "--shadow-softness nan"]
        {
            assert!(parse(&format!("x {line}")).is_err(), "{line}");
        }
    }
}
