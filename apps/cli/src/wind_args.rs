//! The wind of `tresses render`.

use std::str::FromStr;
use tresses_scene::Settings;

/// The wind.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct WindArgs {
    /// Wind: speed in m/s and where it comes from, degrees from the front (0) over the head's left (90) to the back (180) [default: 0]
    #[arg(long, value_name = "SPEED[,DEGREES]", help_heading = "Simulation")]
    wind: Option<Blow>,
    /// How gusty it is: standard deviation over mean speed; 0.1 over water, 0.2 over land, 0.4 between houses [default: 0.2]
    #[arg(long, value_name = "INTENSITY", value_parser = intensity, help_heading = "Simulation")]
    gusts: Option<f32>,
    /// Another number, other gusts [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=9999), help_heading = "Simulation")]
    wind_seed: Option<u32>,
}

impl WindArgs {
    /// Puts what is given into `settings`.
    pub fn apply(&self, settings: &mut Settings) {
        if let Some(Blow { speed, degrees }) = self.wind {
            settings.wind.speed = speed;
            settings.wind.direction = degrees.map_or(settings.wind.direction, f32::to_radians);
        }
        let air = &mut settings.simulation.wind;
        air.turbulence = self.gusts.unwrap_or(air.turbulence);
        air.seed = self.wind_seed.unwrap_or(air.seed);
    }
}

/// A wind's speed and direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Blow {
    /// m/s.
    speed: f32,
    /// Where it comes from.
    degrees: Option<f32>,
}

impl FromStr for Blow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let say = "give a speed from 0 to 100 m/s, or speed,degrees as in 8,45";
        let number = |text: &str, least: f32, most: f32| match text.trim().parse() {
            Ok(value) if (least..=most).contains(&value) => Ok(value),
            _ => Err(say.to_owned()),
        };
        let (speed, degrees) = match text.split_once(',') {
            Some((speed, degrees)) => (speed, Some(number(degrees, -360.0, 360.0)?)),
            None => (text, None),
        };
        Ok(Self { speed: number(speed, 0.0, 100.0)?, degrees })
    }
}

fn intensity(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("give a number from 0 to 1".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::glam::Vec3;

    #[test]
    fn the_wind_comes_from_where_it_is_said() {
        let blow = |text: &str| {
            let mut settings = Settings::default();
            WindArgs { wind: text.parse().ok(), ..Default::default() }.apply(&mut settings);
            settings.physics().wind.velocity
        };
        assert_eq!(blow("0").length(), 0.0);
        assert!((blow("8") - Vec3::new(0.0, 0.0, -8.0)).length() < 1e-5, "from the front: towards the back");
        assert!((blow("8, 90") - Vec3::new(-8.0, 0.0, 0.0)).length() < 1e-5, "from the left, which is +X");
        for text in ["", "fast", "-1", "8,", "101", "8,north", "nan"] {
            assert!(text.parse::<Blow>().is_err(), "{text}");
        }
        // What is not given stays.
        let mut settings = Settings::default();
        (settings.wind.direction, settings.simulation.wind.turbulence) = (1.0, 0.5);
        WindArgs { wind: "9".parse().ok(), ..Default::default() }.apply(&mut settings);
        assert_eq!((settings.wind.speed, settings.wind.direction), (9.0, 1.0));
        assert_eq!(settings.simulation.wind.turbulence, 0.5);
    }
}
