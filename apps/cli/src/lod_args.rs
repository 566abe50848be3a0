//! The options for how much of the hair is drawn, and files of painted levels.

use crate::scalp_map::MapSource;
use anyhow::{Context, Error, Result};
use serde::Deserialize;
use std::{path::Path, str::FromStr};
use tresses::lod::{LodLevel, LodMode};
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

/// A file of painted levels.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    levels: Vec<Level>,
}

/// One of them: names of maps, or pictures beside the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Level {
    /// Pixels.
    size: f32,
    density: Option<String>,
    thickness: Option<String>,
}

/// The painted levels that the .json file at `path` names: black draws no strand, white all; black is a
/// quarter as wide, white four times, middle grey as it was.
pub fn levels(path: &Path) -> Result<Vec<LodLevel>> {
    let read = || -> Result<Vec<LodLevel>> {
        let file: File = serde_json::from_slice(&std::fs::read(path)?)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let map = |name: &Option<String>, value: &dyn Fn(f32) -> f32| {
            let read = |name: &String| {
                let source = match name.parse().map_err(Error::msg)? {
                    MapSource::Picture(path, channel) => MapSource::Picture(folder.join(path), channel),
                    named => named,
                };
                anyhow::Ok(source.read()?.map(value))
            };
            name.as_ref().map(read).transpose()
        };
        file.levels
            .iter()
            .map(|level| {
                Ok(LodLevel {
                    size: level.size,
                    density: map(&level.density, &|grey| grey)?,
                    thickness: map(&level.thickness, &|grey| 4f32.powf(2.0 * grey - 1.0))?,
                })
            })
            .collect()
    };
    read().with_context(|| path.display().to_string())
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

    #[test]
    fn levels_are_read_beside_their_file() {
        let folder = tempfile::tempdir().unwrap();
        let mut encoder =
            png::Encoder::new(std::fs::File::create(folder.path().join("d.png")).unwrap(), 1, 1);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[51]).unwrap();
        let path = folder.path().join("levels.json");
        let text = r#"{"levels": [{"size": 300}, {"size": 40, "density": "d.png", "thickness": "d.png"}]}"#;
        std::fs::write(&path, text).unwrap();
        let levels = levels(&path).unwrap();
        assert_eq!((levels.len(), &levels[0].density), (2, &None));
        let at = |map: &Option<tresses::groom::grow::ScalpMap>| {
            map.as_ref().unwrap().sample(tresses::glam::Vec2::splat(0.5))
        };
        assert!((at(&levels[1].density) - 0.2).abs() < 1e-5);
        assert!((at(&levels[1].thickness) - 4f32.powf(-0.6)).abs() < 1e-5);
        std::fs::write(&path, text.replace("d.png", "e.png")).unwrap();
        let error = format!("{:#}", super::levels(&path).unwrap_err());
        assert!(error.contains("levels.json") && error.contains("e.png"), "{error}");
        std::fs::write(&path, text.replace("size", "sise")).unwrap();
        assert!(super::levels(&path).is_err());
    }
}
