//! The options for how much of the hair is drawn.

use std::str::FromStr;
use tresses::lod::LodMode;
use tresses_scene::{Settings, settings::LodChoice};

/// How much of the hair is drawn.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
#[command(next_help_heading = "Level of detail")]
pub struct LodArgs {
    /// Strands that are drawn, those left being wider: `auto` by the size of a pixel, `off` for all at any
    /// distance, or a share of them such as 0.25 [default: auto]
    #[arg(long = "lod", value_name = "auto|off|FRACTION")]
    pub mode: Option<Mode>,
    /// With `auto`: 1 draws as if the hair were twice as far away, -1 half as far [default: 0]
    #[arg(long, value_name = "STEPS", allow_negative_numbers = true, value_parser = bias)]
    pub lod_bias: Option<f32>,
}

impl LodArgs {
    /// Puts what is given into `settings`.
    pub fn apply(&self, settings: &mut Settings) {
        let lod = &mut settings.lod;
        match self.mode.map(|mode| mode.0) {
            None => {}
            Some(LodMode::Auto) => lod.mode = LodChoice::Auto,
            Some(LodMode::Off) => lod.mode = LodChoice::Off,
            Some(LodMode::Fixed(fraction)) => (lod.mode, lod.fraction) = (LodChoice::Fixed, fraction),
        }
        lod.bias = self.lod_bias.unwrap_or(lod.bias);
    }
}

/// What `--lod` says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode(pub LodMode);

impl FromStr for Mode {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("auto", _) => Ok(Self(LodMode::Auto)),
            ("off", _) => Ok(Self(LodMode::Off)),
            (_, Ok(fraction)) if (1e-4..=1.0).contains(&fraction) => Ok(Self(LodMode::Fixed(fraction))),
            _ => Err("choose auto, off, or a share of the strands from 0.0001 to 1".into()),
        }
    }
}

fn bias(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(bias) if (-8.0..=8.0).contains(&bias) => Ok(bias),
        _ => Err("give a number from -8 to 8".into()),
    }
}

/// Metres between the camera and the middle of what it looks at.
pub fn distance(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(distance) if (0.1..=1000.0).contains(&distance) => Ok(distance),
        _ => Err("give metres, from 0.1 to 1000".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_mean_what_they_say() {
        assert_eq!("auto".parse(), Ok(Mode(LodMode::Auto)));
        assert_eq!("off".parse(), Ok(Mode(LodMode::Off)));
        assert_eq!("0.25".parse(), Ok(Mode(LodMode::Fixed(0.25))));
        for wrong in ["", "on", "0", "1.5", "NaN", "-1"] {
            assert!(wrong.parse::<Mode>().is_err(), "{wrong}");
        }
        assert!(bias("9").is_err() && bias("-2").is_ok());
        assert!(distance("0").is_err() && distance("15").is_ok() && distance("inf").is_err());
    }
}
