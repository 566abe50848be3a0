//! What the options of several subcommands mean, and the sentences for values that make no sense.

use crate::{orient_args::OrientArgs, style_args::StyleArgs};
use anyhow::{Result, ensure};
use std::{path::PathBuf, str::FromStr};
use tresses_scene::{Preset, knobs::color, settings::HairColor};

/// The widest or highest picture, pixels.
const MAX_SIDE: u32 = 16_384;

/// The most pixels of one picture: 8K.
const MAX_PIXELS: u64 = 7680 * 4320;

/// Which hair on which head.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct SourceArgs {
    /// Groom files (.tfx, .hair, .obj), joined into one groom; without any, a built-in style
    #[arg(value_name = "GROOM")]
    pub grooms: Vec<PathBuf>,
    /// The head that the groom grows on and collides with (.obj, .gltf, .glb); may be given again, for eyes and clothes
    #[arg(long, value_name = "MESH", requires = "grooms")]
    pub head: Vec<PathBuf>,
    /// A built-in hairstyle: long, bob, curly or short
    #[arg(long, value_name = "NAME", conflicts_with = "grooms")]
    pub style: Option<String>,
    /// Hair colour: blond, brown, red, black or an sRGB colour such as 5a3b28 [default: the file's, or brown]
    #[arg(long, value_name = "NAME|RRGGBB")]
    pub color: Option<Color>,
    /// How many strands are drawn, at most
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4_000_000))]
    pub strands: Option<u32>,
    /// How many strands of a groom are simulated, the others following them: a number or `all`
    #[arg(long, value_name = "N|all")]
    pub guides: Option<Guides>,
    /// More that hair collides with, and how it moves: a file of capsules, ellipsoids and meshes (.json)
    #[arg(long, value_name = "FILE")]
    pub colliders: Option<PathBuf>,
    /// Painted levels of detail: a .json file of sizes in pixels, each with grey pictures over the scalp of
    /// density and thickness, {"levels": [{"size": 300}, {"size": 40, "density": "d.png", "thickness": "t.png"}]}
    #[arg(long, value_name = "FILE", help_heading = "Level of detail")]
    pub lod_maps: Option<PathBuf>,
    #[command(flatten)]
    pub orientation: OrientArgs,
    #[command(flatten)]
    pub shape: StyleArgs,
}

impl SourceArgs {
    /// Puts what is given into `preset`.
    pub fn apply(&self, preset: &mut Preset) -> Result<()> {
        ensure!(
            self.color.is_none() || self.shape.color_map.is_none(),
            "--color gives all hair one colour and --color-map many; give one of them"
        );
        let source = &mut preset.source;
        if !self.grooms.is_empty() || self.style.is_some() {
            // Another hair: the preset's head and axes are those of its own.
            source.style.clone_from(&self.style);
            source.grooms.clone_from(&self.grooms);
            source.heads.clone_from(&self.head);
            source.orientation = Default::default();
        }
        self.orientation.apply(&mut source.orientation);
        let file = |path: &PathBuf| path.display().to_string();
        source.colliders = self.colliders.as_ref().map(file).or(source.colliders.take());
        source.lod_maps = self.lod_maps.as_ref().map(file).or(source.lod_maps.take());
        let style = &mut preset.settings.style;
        style.strands = self.strands.or(style.strands);
        match self.guides {
            None => {}
            Some(Guides::All) => style.all_guides = true,
            Some(Guides::Count(count)) => (style.guides, style.all_guides) = (Some(count), false),
        }
        let look = &mut preset.settings.look;
        match self.color {
            None => {}
            Some(Color::Preset(color)) => look.color = color,
            Some(Color::Srgb(srgb)) => (look.color, look.srgb) = (HairColor::Srgb, srgb),
        }
        if self.color.is_some() {
            preset.source.color_map = None;
        }
        self.shape.apply(preset);
        Ok(())
    }
}

/// A hair colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Color {
    /// A preset by its name.
    Preset(HairColor),
    /// sRGB, 0 to 255.
    Srgb([u8; 3]),
}

impl FromStr for Color {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(match (text, color(text)) {
            ("blond", _) => Self::Preset(HairColor::Blond),
            ("brown", _) => Self::Preset(HairColor::Brown),
            ("red", _) => Self::Preset(HairColor::Red),
            ("black", _) => Self::Preset(HairColor::Black),
            (_, Some(srgb)) => Self::Srgb(srgb),
            _ => return Err("choose blond, brown, red, black or six hexadecimal digits RRGGBB".into()),
        })
    }
}

/// How many strands of a groom are guides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guides {
    /// Every strand is simulated.
    All,
    /// That many, well spread.
    Count(u32),
}

impl FromStr for Guides {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            Ok(count) if count > 0 => Ok(Self::Count(count)),
            _ if text == "all" => Ok(Self::All),
            _ => Err("give a number from 1 on, or `all`".into()),
        }
    }
}

/// The size of a picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text
            .split_once(['x', 'X', '×'])
            .and_then(|(w, h)| Some((w.parse::<u32>().ok()?, h.parse::<u32>().ok()?)))
            .ok_or("give width x height in pixels, as in 1280x720")?;
        if !(16..=MAX_SIDE).contains(&width) || !(16..=MAX_SIDE).contains(&height) {
            return Err(format!("each side must be 16 to {MAX_SIDE} pixels long"));
        }
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(format!("a picture has at most {MAX_PIXELS} pixels (7680x4320)"));
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

/// Samples per pixel.
pub fn samples(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(n @ (1 | 4 | 8 | 16)) => Ok(n),
        _ => Err("choose 1, 4, 8 or 16".into()),
    }
}

/// Frames per second.
pub fn fps(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(fps) if (1.0..=1000.0).contains(&fps) => Ok(fps),
        _ => Err("give a number from 1 to 1000".into()),
    }
}

/// How near the camera is: a name or a factor.
pub fn zoom(text: &str) -> Result<f32, String> {
    match text {
        "close" => Ok(2.2),
        "normal" => Ok(1.0),
        "far" => Ok(0.35),
        _ => match text.parse() {
            Ok(zoom) if (0.01..=20.0).contains(&zoom) => Ok(zoom),
            _ => Err("choose close, normal, far or a factor from 0.01 to 20".into()),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_mean_what_they_say() {
        assert_eq!("1280x720".parse(), Ok(Size { width: 1280, height: 720 }));
        assert_eq!("FF8000".parse(), Ok(Color::Srgb([255, 128, 0])));
        assert_eq!("#ff8000".parse(), Ok(Color::Srgb([255, 128, 0])));
        assert_eq!("all".parse(), Ok(Guides::All));
        assert_eq!("12".parse(), Ok(Guides::Count(12)));
        assert_eq!(zoom("normal"), Ok(1.0));
        assert_eq!("red".parse(), Ok(Color::Preset(HairColor::Red)));
    }

    #[test]
    fn options_win_over_a_preset() {
        let mut preset = Preset::default();
        preset.source.grooms = vec!["a.tfx".into()];
        preset.source.heads = vec!["head.obj".into()];
        preset.source.orientation.orient.unit = "cm".parse().ok();
        (preset.settings.style.guides, preset.settings.style.frizz) = (Some(40), Some(0.001));
        let mut other = preset.clone();
        SourceArgs::default().apply(&mut other).unwrap();
        assert_eq!(other, preset, "nothing is given");
        let args = SourceArgs { guides: Some(Guides::All), color: "red".parse().ok(), ..Default::default() };
        args.apply(&mut other).unwrap();
        assert!(other.settings.style.all_guides && other.settings.look.color == HairColor::Red);
        assert_eq!((&other.source, other.settings.style.frizz), (&preset.source, Some(0.001)));
        let args = SourceArgs { grooms: vec!["b.tfx".into()], ..Default::default() };
        args.apply(&mut other).unwrap();
        assert_eq!(other.source.grooms, args.grooms);
        assert!(other.source.heads.is_empty() && other.source.orientation == Default::default());
    }

    #[test]
    fn nonsense_is_refused() {
        for size in ["", "12", "0x0", "8x8", "axb", "20000x100", "16000x16000", "-1x100", "100x100x100"] {
            assert!(size.parse::<Size>().is_err(), "{size}");
        }
        for color in ["", "green", "12345", "+12345", "1234567"] {
            assert!(color.parse::<Color>().is_err(), "{color}");
        }
        assert!("0".parse::<Guides>().is_err() && "none".parse::<Guides>().is_err());
        assert!(samples("3").is_err() && fps("0").is_err() && fps("NaN").is_err() && zoom("0").is_err());
    }
}
