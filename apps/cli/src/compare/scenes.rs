//! The description of the reference pictures, and the locations of the files that it names.

use super::metrics::Linear;
use crate::picture::{self, Picture};
use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// All of it.
#[derive(Debug, Deserialize)]
pub struct Scenes {
    /// Behind everything, linear.
    pub background_linear: f32,
    /// From everywhere, linear.
    pub environment_radiance_rgb: [f32; 3],
    grooms: BTreeMap<String, Groom>,
    pictures: BTreeMap<String, Shot>,
}

/// One groom on its head, in its own unit.
#[derive(Debug, Deserialize)]
pub struct Groom {
    scale_note: String,
    strand_file: String,
    /// Of every strand.
    pub radius: Radius,
    /// Where the picture is taken from.
    pub camera: WantedCamera,
    /// By name.
    pub lights: BTreeMap<String, Light>,
    /// What is drawn with the hair.
    pub head_parts: Vec<Part>,
}

/// Linear in the vertex index.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Radius {
    /// In the groom's unit.
    pub root: f32,
    /// In the groom's unit.
    pub tip: f32,
}

/// A pinhole camera, upright.
#[derive(Debug, Deserialize)]
pub struct WantedCamera {
    /// Where it is.
    pub origin: [f32; 3],
    /// What it looks at.
    pub target: [f32; 3],
    /// Degrees.
    pub vertical_fov_degrees: f32,
    /// Width and height, pixels.
    pub resolution: [u32; 2],
}

/// A light with parallel rays.
#[derive(Debug, Deserialize)]
pub struct Light {
    /// Unit.
    pub direction_to_light: [f32; 3],
    /// On a plane that faces it, linear.
    pub irradiance_rgb: [f32; 3],
}

/// A matt mesh.
#[derive(Debug, Deserialize)]
pub struct Part {
    /// Beside the description.
    pub file: PathBuf,
    /// Linear.
    pub reflectance_rgb: [f32; 3],
    /// Its place, in the groom's unit.
    pub to_world_row_major: [[f32; 4]; 4],
}

#[derive(Debug, Deserialize)]
struct Shot {
    groom: Option<String>,
    material: Option<String>,
    #[serde(default)]
    lights: Vec<String>,
    #[serde(default)]
    environment: bool,
    #[serde(default)]
    mean_rgb_hair_pixels: [f64; 3],
    #[serde(default)]
    noise: Noise,
    /// The same picture by each light alone.
    #[serde(default)]
    per_light_files: Vec<PathBuf>,
    /// Two: light that one surface has scattered, once.
    #[serde(default)]
    max_depth: u32,
    #[serde(default = "yes")]
    shadow_rays: bool,
}

/// How far pixels are off because paths are few.
#[derive(Debug, Default, Deserialize)]
struct Noise {
    #[serde(default)]
    picture_rmse_linear_hair_pixels_estimate: f64,
}

fn yes() -> bool {
    true
}

/// One picture that can be compared.
#[derive(Clone, Copy)]
pub struct WantedView<'a> {
    /// Of the picture.
    pub name: &'a str,
    /// Of the groom.
    pub groom_name: &'a str,
    /// The groom.
    pub groom: &'a Groom,
    /// Name of the hair's material.
    pub material: &'a str,
    /// Names of the lights that are on.
    pub lights: &'a [String],
    /// Whether the environment is.
    pub environment: bool,
    /// By how much of their radiance the hair's pixels are off, root mean square.
    pub noise: f64,
    /// The same picture by each light alone.
    alone: &'a [PathBuf],
}

/// A picture of the reference as it was computed, before nothing.
pub struct Reference {
    /// Its radiance.
    pub linear: Linear,
    /// The share of each pixel that hair or a body covers.
    pub alpha: Vec<f32>,
}

/// Two pictures of light that is scattered once, with shadows and without.
pub struct Pair<'a> {
    /// The one with shadows.
    pub view: WantedView<'a>,
    /// The name of the other.
    pub unshadowed: &'a str,
}

impl Scenes {
    /// Reads a description.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read(path).with_context(|| path.display().to_string())?;
        serde_json::from_slice(&text).with_context(|| format!("{}: no description of scenes", path.display()))
    }

    /// The named pictures, or all with light from everywhere; groom by groom.
    pub fn views(&self, only: &[String]) -> Result<Vec<WantedView<'_>>> {
        if let Some(name) = only.iter().find(|name| !self.pictures.contains_key(*name)) {
            let names: Vec<_> = self.pictures.keys().map(String::as_str).collect();
            bail!("there is no picture {name}; choose {}", names.join(", "));
        }
        let mut views = Vec::new();
        for (name, shot) in &self.pictures {
            let wanted = if only.is_empty() { shot.environment } else { only.contains(name) };
            if !wanted || shot.scatters_once() {
                continue;
            }
            match self.view(name, shot)? {
                Some(view) => views.push(view),
                None => ensure!(only.is_empty(), "{name} shows no shaded hair"),
            }
        }
        views.sort_by_key(|view| view.groom_name);
        Ok(views)
    }

    /// The pictures that tell how much of a light arrives: those that are named, or all.
    pub fn pairs(&self, only: &[String]) -> Result<Vec<Pair<'_>>> {
        let mut pairs = Vec::new();
        for (name, shot) in &self.pictures {
            if !(shot.scatters_once() && shot.shadow_rays && (only.is_empty() || only.contains(name))) {
                continue;
            }
            let twin = self.pictures.iter().find(|(_, other)| {
                other.scatters_once()
                    && !other.shadow_rays
                    && (&other.groom, &other.material, &other.lights)
                        == (&shot.groom, &shot.material, &shot.lights)
            });
            if let (Some(view), Some((unshadowed, _))) = (self.view(name, shot)?, twin) {
                pairs.push(Pair { view, unshadowed });
            }
        }
        Ok(pairs)
    }

    /// The view of a picture that shows shaded hair.
    fn view<'a>(&'a self, name: &'a str, shot: &'a Shot) -> Result<Option<WantedView<'a>>> {
        let (Some(groom_name), Some(material)) = (&shot.groom, &shot.material) else { return Ok(None) };
        let groom = self.grooms.get(groom_name).with_context(|| format!("{name}: no groom {groom_name}"))?;
        Ok(Some(WantedView {
            name,
            groom_name,
            groom,
            material,
            lights: &shot.lights,
            environment: shot.environment,
            noise: shot.noise(),
            alone: &shot.per_light_files,
        }))
    }
}

impl<'a> WantedView<'a> {
    /// The same by each light alone, as far as there are pictures of that.
    pub fn alone(&self) -> impl Iterator<Item = Self> {
        let view = *self;
        self.alone.iter().filter_map(move |file| {
            let name = file.file_stem()?.to_str()?;
            let light = name.strip_prefix(view.name)?.strip_prefix('_')?;
            let one = view.lights.iter().find(|known| *known == light).map(std::slice::from_ref);
            let environment = light == "env" && view.environment;
            (environment || one.is_some()).then(|| Self {
                name,
                lights: one.unwrap_or_default(),
                environment,
                alone: &[],
                ..view
            })
        })
    }
}

impl Shot {
    /// Of the mean radiance, as a path tracer's noise is of each pixel's.
    fn noise(&self) -> f64 {
        let mean = (self.mean_rgb_hair_pixels.iter().map(|c| c * c).sum::<f64>() / 3.0).sqrt();
        self.noise.picture_rmse_linear_hair_pixels_estimate / mean.max(1e-12)
    }

    fn scatters_once(&self) -> bool {
        self.max_depth == 2
    }
}

impl Groom {
    /// Metres per unit, from what the description says about it.
    pub fn unit(&self) -> Result<f32> {
        let words: Vec<_> = self.scale_note.split_whitespace().collect();
        let found = words.windows(2).find_map(|pair| {
            let size = match pair[1].trim_end_matches(|c: char| !c.is_alphabetic()) {
                "mm" => 1e-3,
                "cm" => 1e-2,
                "m" => 1.0,
                _ => return None,
            };
            Some(pair[0].parse::<f32>().ok()? * size)
        });
        found.with_context(|| format!("no unit in \"{}\"", self.scale_note))
    }

    /// Where the strands are.
    pub fn strands(&self, folders: &Folders<'_>) -> Result<PathBuf> {
        // The path is followed by remarks in brackets.
        let path = self.strand_file.split(" (").next().unwrap_or_default();
        match path.strip_prefix("asset ") {
            None => Ok(folders.beside(Path::new(path))),
            Some(path) => {
                let assets =
                    folders.assets.context("the grooms are assets: give their folder with --assets")?;
                Ok(assets.join(path))
            }
        }
    }
}

/// Where things lie.
pub struct Folders<'a> {
    /// The description.
    pub scenes: &'a Path,
    /// The grooms.
    pub assets: Option<&'a Path>,
}

impl Folders<'_> {
    /// A file that lies beside the description.
    pub fn beside(&self, path: &Path) -> PathBuf {
        self.scenes.parent().unwrap_or(Path::new("")).join(path)
    }

    /// The linear radiance of a picture of `size` pixels that lies there.
    pub fn radiance(&self, name: &str, size: (u32, u32)) -> Result<Reference> {
        let path = self.beside(Path::new(&format!("{name}.exr")));
        let picture = image::open(&path).with_context(|| path.display().to_string())?.into_rgba32f();
        let (width, height) = size;
        ensure!(
            picture.dimensions() == size,
            "{}: {} × {} pixels, its description says {width} × {height}",
            path.display(),
            picture.width(),
            picture.height()
        );
        let (pixels, alpha) = picture.pixels().map(|p| ([p.0[0], p.0[1], p.0[2]], p.0[3])).unzip();
        Ok(Reference { linear: Linear { width, pixels }, alpha })
    }

    /// Where the picture of `view`, of `size` pixels, shows hair.
    pub fn mask(&self, view: &WantedView<'_>, size: (u32, u32)) -> Result<Picture> {
        let mask = self.picture(&format!("{}_hairmask", view.groom_name))?;
        ensure!(
            (mask.width, mask.height) == size,
            "{}: the mask of the hair is {} × {} pixels, the picture {} × {}",
            view.name,
            mask.width,
            mask.height,
            size.0,
            size.1
        );
        Ok(mask)
    }

    /// A picture that lies there.
    pub fn picture(&self, name: &str) -> Result<Picture> {
        picture::read(&self.beside(Path::new(&format!("{name}.png"))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn groom(scale_note: &str) -> Groom {
        Groom {
            scale_note: scale_note.into(),
            strand_file: "asset a/b.tfx (all strands)".into(),
            radius: Radius { root: 1.0, tip: 1.0 },
            camera: WantedCamera {
                origin: [0.0; 3],
                target: [0.0; 3],
                vertical_fov_degrees: 30.0,
                resolution: [960, 600],
            },
            lights: BTreeMap::new(),
            head_parts: Vec::new(),
        }
    }

    #[test]
    fn notes_tell_the_unit() {
        for (note, unit) in [
            ("1 unit = 1 m", 1.0),
            ("1 unit is about 3.7 mm (bald head)", 3.7e-3),
            ("1 unit is about 4.2 mm; file is Z-up", 4.2e-3),
        ] {
            let found: f32 = groom(note).unit().unwrap();
            assert!((found / unit - 1.0).abs() < 1e-6, "{note}: {found}");
        }
        assert!(groom("unknown").unit().is_err());
    }

    #[test]
    fn strands_lie_among_the_assets_or_beside() {
        let folders = Folders { scenes: Path::new("ref/scenes.json"), assets: Some(Path::new("assets")) };
        let mut groom = groom("");
        assert_eq!(groom.strands(&folders).unwrap(), Path::new("assets/a/b.tfx"));
        assert!(groom.strands(&Folders { assets: None, ..folders }).is_err());
        groom.strand_file = "geometry/c.tfx (float32)".into();
        assert_eq!(groom.strands(&folders).unwrap(), Path::new("ref/geometry/c.tfx"));
    }
}
