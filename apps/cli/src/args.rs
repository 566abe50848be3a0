//! Options shared by several subcommands, and the messages for invalid values.

use crate::orient_args::OrientArgs;
use std::{path::PathBuf, str::FromStr};
use tresses::groom::formats;
use tresses_scene::Preset;

/// Largest width or height of an image, pixels.
const MAX_SIDE: u32 = 16_384;

/// Most pixels of an image: 8K.
const MAX_PIXELS: u64 = 7680 * 4320;

/// Both limits, in words.
const LIMITS: &str = "16 to 16384 pixels, and the image at most 33,177,600 (7680x4320)";

/// Hair and head.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Hair")]
pub struct SourceArgs {
    /// Groom files
    #[arg(value_name = "GROOM", help_heading = None, help = grooms_help("joined into one groom; if omitted, a built-in style"))]
    pub grooms: Vec<PathBuf>,
    /// Mesh that the groom grows on and collides with
    #[arg(long, value_name = "MESH", help = head_help("without a groom, a built-in style grows on it; may be repeated, for eyes and clothes"))]
    pub head: Vec<PathBuf>,
    /// Built-in hairstyle: long, bob, curly or short
    #[arg(long, value_name = "NAME", conflicts_with = "grooms")]
    pub style: Option<String>,
    /// Units and axes of the files.
    #[command(flatten)]
    pub orientation: OrientArgs,
}

/// Returns the help text of groom files.
pub fn grooms_help(more: &str) -> String {
    format!("Groom files ({}), {more}", formats::listed(formats::GROOMS, "or"))
}

/// Returns the help text of head meshes.
pub fn head_help(more: &str) -> String {
    let meshes = formats::listed(formats::MESHES, "or");
    format!("Mesh that the groom grows on and collides with ({meshes}); {more}")
}

impl SourceArgs {
    /// Applies the given options to `preset`.
    pub fn apply(&self, preset: &mut Preset) {
        let source = &mut preset.source;
        if !self.grooms.is_empty() || self.style.is_some() {
            // The preset's head and axes belong to the hair that is replaced.
            source.style.clone_from(&self.style);
            source.grooms.clone_from(&self.grooms);
            source.heads.clone_from(&self.head);
            source.orientation = Default::default();
        } else if !self.head.is_empty() {
            source.heads.clone_from(&self.head);
        }
        self.orientation.apply(&mut source.orientation);
    }
}

/// Size of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text
            .split_once(['x', 'X', '×'])
            .and_then(|(w, h)| Some((w.parse::<u32>().ok()?, h.parse::<u32>().ok()?)))
            .ok_or("expected WIDTHxHEIGHT in pixels, as in 1280x720")?;
        if !(16..=MAX_SIDE).contains(&width) || !(16..=MAX_SIDE).contains(&height) {
            return Err(format!("each side must be {LIMITS}"));
        }
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(format!("{width}x{height} are too many pixels: each side must be {LIMITS}"));
        }
        Ok(Self { width, height })
    }
}

impl Size {
    /// Width over height.
    pub fn aspect(self) -> f32 {
        self.width as f32 / self.height as f32
    }
}

/// Parses the distance between the camera and its target, meters.
pub fn distance(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(distance) if (0.1..=1000.0).contains(&distance) => Ok(distance),
        _ => Err("expected meters, from 0.1 to 1000".into()),
    }
}

/// Parses the number of samples per pixel.
pub fn samples(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(n @ (1 | 4 | 8 | 16)) => Ok(n),
        _ => Err("expected 1, 4, 8 or 16".into()),
    }
}

/// Parses the frame rate, frames per second.
pub fn fps(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(fps) if (1.0..=1000.0).contains(&fps) => Ok(fps),
        _ => Err("expected a number from 1 to 1000".into()),
    }
}

/// Parses the zoom: a name or a factor.
pub fn zoom(text: &str) -> Result<f32, String> {
    match text {
        "close" => Ok(2.2),
        "normal" => Ok(1.0),
        "far" => Ok(0.35),
        _ => match text.parse() {
            Ok(zoom) if (0.01..=20.0).contains(&zoom) => Ok(zoom),
            _ => Err("expected close, normal, far or a factor from 0.01 to 20".into()),
        },
    }
}

/// Parses a morph target and its weight.
pub fn morph(text: &str) -> Result<(String, f32), String> {
    let (name, weight) = text.split_once('=').ok_or("expected NAME=WEIGHT")?;
    match weight.parse() {
        Ok(weight) if (-10.0..=10.0).contains(&weight) && !name.is_empty() => Ok((name.into(), weight)),
        _ => Err("the weight must be a number from -10 to 10".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses_scene::words::grouped;

    #[test]
    fn size_zoom_and_distance_parse() {
        assert_eq!("1280x720".parse(), Ok(Size { width: 1280, height: 720 }));
        assert_eq!(zoom("normal"), Ok(1.0));
        assert_eq!(distance("15"), Ok(15.0));
    }

    #[test]
    fn size_limits_match_their_message() {
        assert!(LIMITS.contains(&format!("16 to {MAX_SIDE} ")) && LIMITS.contains(&grouped(MAX_PIXELS)));
        let widest = (MAX_PIXELS / u64::from(MAX_SIDE)) as u32;
        assert!(format!("{MAX_SIDE}x{widest}").parse::<Size>().is_ok());
        assert!(format!("{MAX_SIDE}x{}", widest + 1).parse::<Size>().is_err());
    }

    #[test]
    fn given_groom_replaces_the_presets_hair() {
        let mut preset = Preset::default();
        preset.source.grooms = vec!["a.tfx".into()];
        preset.source.heads = vec!["head.obj".into()];
        preset.source.orientation.orient.unit = "cm".parse().ok();
        let mut other = preset.clone();
        SourceArgs::default().apply(&mut other);
        assert_eq!(other, preset, "nothing is given");
        let args = SourceArgs { grooms: vec!["b.tfx".into()], ..Default::default() };
        args.apply(&mut other);
        assert_eq!(other.source.grooms, args.grooms);
        assert!(other.source.heads.is_empty() && other.source.orientation == Default::default());
        // A head alone goes under the preset's hair.
        let args = SourceArgs { head: vec!["c.obj".into()], ..Default::default() };
        args.apply(&mut other);
        assert_eq!((other.source.grooms.len(), &other.source.heads), (1, &args.head));
    }

    #[test]
    fn invalid_values_are_errors() {
        for size in ["", "12", "0x0", "8x8", "axb", "20000x100", "16000x16000", "-1x100", "100x100x100"] {
            assert!(size.parse::<Size>().is_err(), "{size}");
        }
        assert!(samples("3").is_err() && fps("0").is_err() && fps("NaN").is_err() && zoom("0").is_err());
        assert!(distance("0").is_err() && distance("inf").is_err());
    }
}
