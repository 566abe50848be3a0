//! The option for a picture of the surroundings that lights the scene.

use anyhow::{Result, ensure};
use std::path::PathBuf;
use tresses_scene::Preset;

/// Light from a picture of the surroundings.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Light")]
pub struct EnvironmentArgs {
    /// An equirectangular picture of the surroundings (.hdr or .exr) that gives all light instead of
    /// key, rim and sky; its middle lies before the face
    #[arg(long, value_name = "FILE")]
    pub environment: Option<PathBuf>,
    /// By how much the surroundings are turned, towards the head's left, degrees [default: 0]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = turn)]
    pub environment_turn: Option<f32>,
    /// What their light is multiplied by [default: 1]
    #[arg(long, value_name = "FACTOR", value_parser = strength)]
    pub environment_strength: Option<f32>,
}

fn turn(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(turn) if (-360.0..=360.0).contains(&turn) => Ok(turn),
        _ => Err("give degrees from -360 to 360".into()),
    }
}

fn strength(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(strength) if (0.001..=1000.0).contains(&strength) => Ok(strength),
        _ => Err("give a factor from 0.001 to 1000".into()),
    }
}

impl EnvironmentArgs {
    /// Puts what is given into `preset`.
    pub fn apply(&self, preset: &mut Preset) -> Result<()> {
        if let Some(path) = &self.environment {
            preset.source.environment = Some(path.display().to_string());
        }
        ensure!(
            preset.source.environment.is_some()
                || self.environment_turn.is_none() && self.environment_strength.is_none(),
            "there are no surroundings to turn or to strengthen: give --environment"
        );
        let lights = &mut preset.settings.lights;
        lights.environment_turn = self.environment_turn.map_or(lights.environment_turn, f32::to_radians);
        lights.environment_strength = self.environment_strength.unwrap_or(lights.environment_strength);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surroundings_go_into_a_preset() {
        let mut preset = Preset::default();
        let args = EnvironmentArgs {
            environment: Some("sky.hdr".into()),
            environment_turn: Some(90.0),
            environment_strength: Some(2.0),
        };
        args.apply(&mut preset).unwrap();
        assert_eq!(preset.source.environment.as_deref(), Some("sky.hdr"));
        let lights = &preset.settings.lights;
        assert_eq!((lights.environment_turn, lights.environment_strength), (90f32.to_radians(), 2.0));
        let alone = EnvironmentArgs { environment_turn: Some(20.0), ..Default::default() };
        assert!(alone.apply(&mut Preset::default()).is_err(), "there is nothing to turn");
        assert!(turn("400").is_err() && strength("0").is_err() && strength("NaN").is_err());
    }
}
