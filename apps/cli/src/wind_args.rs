//! The wind of `tresses render`.

use std::str::FromStr;
use tresses::{glam::Vec3, simulate::SimulationParams, wind::Wind};

/// The wind.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct WindArgs {
    /// Wind: speed in m/s and where it comes from, degrees from the front (0) over the head's left (90) to the back (180)
    #[arg(long, value_name = "SPEED[,DEGREES]", default_value = "0", help_heading = "Simulation")]
    wind: Blow,
    /// How gusty it is: standard deviation over mean speed; 0.1 over water, 0.2 over land, 0.4 between houses
    #[arg(long, value_name = "INTENSITY", default_value = "0.2", value_parser = intensity, help_heading = "Simulation")]
    gusts: f32,
    /// Another number, other gusts
    #[arg(long, value_name = "N", default_value = "1", help_heading = "Simulation")]
    wind_seed: u32,
}

impl WindArgs {
    /// Makes it blow.
    pub fn apply(&self, physics: &mut SimulationParams) {
        let Blow { speed, degrees } = self.wind;
        let (sin, cos) = degrees.to_radians().sin_cos();
        let velocity = -speed * Vec3::new(sin, 0.0, cos);
        physics.wind = Wind { velocity, turbulence: self.gusts, seed: self.wind_seed, ..physics.wind };
    }
}

/// A wind's speed and direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Blow {
    /// m/s.
    speed: f32,
    /// Where it comes from.
    degrees: f32,
}

impl FromStr for Blow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (speed, degrees) = text.split_once(',').unwrap_or((text, "0"));
        match (speed.trim().parse::<f32>(), degrees.trim().parse::<f32>()) {
            (Ok(speed), Ok(degrees)) if (0.0..=100.0).contains(&speed) && degrees.abs() <= 360.0 => {
                Ok(Self { speed, degrees })
            }
            _ => Err("give a speed from 0 to 100 m/s, or speed,degrees as in 8,45".into()),
        }
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

    #[test]
    fn the_wind_comes_from_where_it_is_said() {
        let blow = |text: &str| {
            let args = WindArgs { wind: text.parse().unwrap(), gusts: 0.2, wind_seed: 1 };
            let mut physics = SimulationParams::default();
            args.apply(&mut physics);
            physics.wind.velocity
        };
        assert_eq!(blow("0").length(), 0.0);
        assert!((blow("8") - Vec3::new(0.0, 0.0, -8.0)).length() < 1e-5, "from the front: towards the back");
        assert!((blow("8, 90") - Vec3::new(-8.0, 0.0, 0.0)).length() < 1e-5, "from the left, which is +X");
        for text in ["", "fast", "-1", "8,", "101", "8,north", "nan"] {
            assert!(text.parse::<Blow>().is_err(), "{text}");
        }
    }
}
