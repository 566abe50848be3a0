//! The description of the reference images, and the paths of the files that it names.

use super::{
    lights::{self, LightDescription},
    metrics::Linear,
};
use crate::picture::{self, Image};
use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Description of the reference.
#[derive(Debug, Deserialize)]
pub struct Scenes {
    /// Background radiance, linear.
    pub background_linear: f32,
    /// Radiance of the uniform environment, linear.
    pub environment_radiance_rgb: [f32; 3],
    grooms: BTreeMap<String, GroomDescription>,
    pictures: BTreeMap<String, Shot>,
}

/// A groom and its head, in the groom's unit.
#[derive(Debug, Deserialize)]
pub struct GroomDescription {
    scale_note: String,
    strand_file: String,
    /// Radius of all strands.
    pub radius: Radius,
    /// The camera.
    pub camera: PinholeCamera,
    /// Lights by name.
    #[serde(deserialize_with = "lights::read")]
    pub lights: BTreeMap<String, LightDescription>,
    /// Meshes drawn with the hair.
    pub head_parts: Vec<MatteMesh>,
    /// Positions of copies of hair and meshes, in the groom's unit.
    #[serde(default = "one")]
    pub copies: Vec<[f32; 3]>,
}

/// Strand radius, linear in the vertex index.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Radius {
    /// At the root, in the groom's unit.
    pub root: f32,
    /// At the tip, in the groom's unit.
    pub tip: f32,
}

/// An upright pinhole camera.
#[derive(Debug, Deserialize)]
pub struct PinholeCamera {
    /// Position of the camera.
    pub origin: [f32; 3],
    /// Point that the camera looks at.
    pub target: [f32; 3],
    /// Vertical field of view, degrees.
    pub vertical_fov_degrees: f32,
    /// Width and height, pixels.
    pub resolution: [u32; 2],
}

/// A diffuse mesh.
#[derive(Debug, Deserialize)]
pub struct MatteMesh {
    /// Path relative to the description.
    pub file: PathBuf,
    /// Reflectance, linear.
    pub reflectance_rgb: [f32; 3],
    /// Transform to world space, in the groom's unit.
    pub to_world_row_major: [[f32; 4]; 4],
}

#[derive(Debug, Deserialize)]
struct Shot {
    groom: Option<String>,
    material: Option<String>,
    #[serde(default)]
    lights: Vec<String>,
    /// Whether the image has all light of its view, and no images with each light alone.
    #[serde(default)]
    all_lights: bool,
    #[serde(default)]
    environment: bool,
    /// Environment map in place of the uniform environment.
    environment_map: Option<PathBuf>,
    /// Eumelanin and pheomelanin, if `material` is not a built-in color.
    pigments: Option<[f32; 2]>,
    /// Roughness along and around the fiber, if not the default.
    roughness: Option<[f32; 2]>,
    #[serde(default)]
    mean_rgb_hair_pixels: [f64; 3],
    #[serde(default)]
    noise: Noise,
    /// Images of the same view with each light alone.
    #[serde(default)]
    per_light_files: Vec<PathBuf>,
    /// Maximum path depth; 2 means single scattering.
    #[serde(default)]
    max_depth: u32,
    #[serde(default = "yes")]
    shadow_rays: bool,
}

/// Noise of the path tracer.
#[derive(Debug, Default, Deserialize)]
struct Noise {
    #[serde(default)]
    picture_rmse_linear_hair_pixels_estimate: f64,
}

fn one() -> Vec<[f32; 3]> {
    vec![[0.0; 3]]
}

fn yes() -> bool {
    true
}

/// Ending of the name of an image that shows only light that was scattered once.
pub const ONCE: &str = "_once";

/// A view to compare.
#[derive(Clone, Copy)]
pub struct ReferenceView<'a> {
    /// Name of the image.
    pub name: &'a str,
    /// Name of the groom.
    pub groom_name: &'a str,
    /// The groom.
    pub groom: &'a GroomDescription,
    /// Name of the hair's material.
    pub material: &'a str,
    /// Names of the active lights.
    pub lights: &'a [String],
    /// Whether the environment is on.
    pub environment: bool,
    /// Environment map in place of the uniform environment.
    pub environment_map: Option<&'a Path>,
    /// Eumelanin and pheomelanin, if `material` is not a built-in color.
    pub pigments: Option<[f32; 2]>,
    /// Roughness along and around the fiber, if not the default.
    pub roughness: Option<[f32; 2]>,
    /// Root-mean-square error of the hair pixels, relative to their mean radiance.
    pub noise: f64,
    /// Whether the image shows only light that was scattered once.
    pub once: bool,
    /// Images of the same view with each light alone.
    single_light_files: &'a [PathBuf],
}

/// A linear image of the reference, in front of nothing.
pub struct Reference {
    /// Radiance.
    pub linear: Linear,
    /// Coverage of each pixel by hair and bodies.
    pub alpha: Vec<f32>,
}

/// Two single-scattering images, with and without shadows.
pub struct Pair<'a> {
    /// The view with shadows.
    pub view: ReferenceView<'a>,
    /// Name of the image without shadows.
    pub unshadowed: &'a str,
}

impl Scenes {
    /// Reads a description.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read(path).with_context(|| path.display().to_string())?;
        let mut scenes: Self = serde_json::from_slice(&text)
            .with_context(|| format!("{}: invalid description of scenes", path.display()))?;
        for map in scenes.pictures.values_mut().filter_map(|shot| shot.environment_map.as_mut()) {
            *map = path.with_file_name(&*map);
        }
        Ok(scenes)
    }

    /// Returns the named views, or all with complete light, sorted by groom.
    pub fn views(&self, only: &[String]) -> Result<Vec<ReferenceView<'_>>> {
        if let Some(name) = only.iter().find(|name| !self.pictures.contains_key(*name)) {
            let names: Vec<_> = self.pictures.keys().map(String::as_str).collect();
            bail!("there is no image {name}; choose {}", names.join(", "));
        }
        let mut views = Vec::new();
        for (name, shot) in &self.pictures {
            let is_requested = if only.is_empty() { shot.is_complete() } else { only.contains(name) };
            if !is_requested || shot.scatters_once() {
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

    /// Returns the named single-scattering pairs, or all.
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

    /// Returns the view of an image, or `None` if it does not show shaded hair.
    fn view<'a>(&'a self, name: &'a str, shot: &'a Shot) -> Result<Option<ReferenceView<'a>>> {
        let (Some(groom_name), Some(material)) = (&shot.groom, &shot.material) else { return Ok(None) };
        let groom =
            self.grooms.get(groom_name).with_context(|| format!("{name}: there is no groom {groom_name}"))?;
        Ok(Some(ReferenceView {
            name,
            groom_name,
            groom,
            material,
            lights: &shot.lights,
            environment: shot.environment,
            environment_map: shot.environment_map.as_deref(),
            pigments: shot.pigments,
            roughness: shot.roughness,
            noise: shot.noise(),
            once: false,
            single_light_files: &shot.per_light_files,
        }))
    }
}

impl<'a> ReferenceView<'a> {
    /// Returns the same view with each light alone, as far as the reference has images of them: all its light, and
    /// light that was scattered once.
    pub fn single_lights(&self) -> impl Iterator<Item = Self> {
        let view = *self;
        self.single_light_files.iter().filter_map(move |file| {
            let name = file.file_stem()?.to_str()?;
            let part = name.strip_prefix(view.name)?.strip_prefix('_')?;
            let (light, once) = part.strip_suffix(ONCE).map_or((part, false), |light| (light, true));
            let one = view.lights.iter().find(|known| *known == light).map(std::slice::from_ref);
            let environment = light == "env" && view.environment;
            (environment || one.is_some()).then(|| Self {
                name,
                lights: one.unwrap_or_default(),
                environment,
                once,
                single_light_files: &[],
                ..view
            })
        })
    }
}

impl Shot {
    /// Returns the noise relative to the mean radiance.
    fn noise(&self) -> f64 {
        let mean = (self.mean_rgb_hair_pixels.iter().map(|c| c * c).sum::<f64>() / 3.0).sqrt();
        self.noise.picture_rmse_linear_hair_pixels_estimate / mean.max(1e-12)
    }

    /// Whether the image has all the light of its view: the description says so, or there is the environment, or there
    /// are images of single lights.
    fn is_complete(&self) -> bool {
        self.all_lights || self.environment || !self.per_light_files.is_empty()
    }

    fn scatters_once(&self) -> bool {
        self.max_depth == 2
    }
}

impl GroomDescription {
    /// Returns the meters per unit, parsed from the scale note.
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
        found.with_context(|| format!("there is no unit in \"{}\"", self.scale_note))
    }

    /// Returns the path of the strands.
    pub fn strands(&self, folders: &Folders<'_>) -> Result<PathBuf> {
        // Remarks in parentheses follow the path.
        let path = self.strand_file.split(" (").next().unwrap_or_default();
        match path.strip_prefix("asset ") {
            None => Ok(folders.resolve(Path::new(path))),
            Some(path) => {
                let assets =
                    folders.assets.context("the grooms are assets: give their folder with --assets")?;
                Ok(assets.join(path))
            }
        }
    }
}

/// Locations of the reference files.
pub struct Folders<'a> {
    /// Path of the description.
    pub scenes: &'a Path,
    /// Folder of the grooms.
    pub assets: Option<&'a Path>,
}

impl Folders<'_> {
    /// Returns a path relative to the description's folder.
    pub fn resolve(&self, path: &Path) -> PathBuf {
        self.scenes.parent().unwrap_or(Path::new("")).join(path)
    }

    /// Reads the linear radiance of an image of `size` pixels.
    pub fn radiance(&self, name: &str, size: (u32, u32)) -> Result<Reference> {
        let path = self.resolve(Path::new(&format!("{name}.exr")));
        let picture = image::open(&path).with_context(|| path.display().to_string())?.into_rgba32f();
        let (width, height) = size;
        ensure!(
            picture.dimensions() == size,
            "{}: the image is {} × {} pixels, but its description says {width} × {height}",
            path.display(),
            picture.width(),
            picture.height()
        );
        let (pixels, alpha) = picture.pixels().map(|p| ([p.0[0], p.0[1], p.0[2]], p.0[3])).unzip();
        Ok(Reference { linear: Linear { width, pixels }, alpha })
    }

    /// Reads the hair mask of `view`, an image of `size` pixels.
    pub fn mask(&self, view: &ReferenceView<'_>, size: (u32, u32)) -> Result<Image> {
        let mask = self.picture(&format!("{}_hairmask", view.groom_name))?;
        ensure!(
            (mask.width, mask.height) == size,
            "{}: the hair mask is {} × {} pixels, but the image is {} × {}",
            view.name,
            mask.width,
            mask.height,
            size.0,
            size.1
        );
        Ok(mask)
    }

    /// Reads whose hair each pixel of `view` has, an image of `size` pixels: the number of the copy, from 1, or 0.
    /// `None` for a single head.
    pub fn heads(&self, view: &ReferenceView<'_>, size: (u32, u32)) -> Result<Option<Vec<u8>>> {
        if view.groom.copies.len() < 2 {
            return Ok(None);
        }
        let heads = self.picture(&format!("{}_heads", view.groom_name))?;
        ensure!(
            (heads.width, heads.height) == size,
            "{}: the mask of the heads is {} × {} pixels, but the image is {} × {}",
            view.name,
            heads.width,
            heads.height,
            size.0,
            size.1
        );
        Ok(Some(heads.rgba.as_chunks::<4>().0.iter().map(|rgba| rgba[0]).collect()))
    }

    /// Reads an image of the reference.
    pub fn picture(&self, name: &str) -> Result<Image> {
        picture::read(&self.resolve(Path::new(&format!("{name}.png"))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn groom(scale_note: &str) -> GroomDescription {
        GroomDescription {
            scale_note: scale_note.into(),
            strand_file: "asset a/b.tfx (all strands)".into(),
            radius: Radius { root: 1.0, tip: 1.0 },
            camera: PinholeCamera {
                origin: [0.0; 3],
                target: [0.0; 3],
                vertical_fov_degrees: 30.0,
                resolution: [960, 600],
            },
            lights: BTreeMap::new(),
            head_parts: Vec::new(),
            copies: one(),
        }
    }

    #[test]
    fn unit_is_parsed_from_the_scale_note() {
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

    /// Names of the views of pictures that have one groom with the lights `key` and `lamp`.
    fn complete(pictures: serde_json::Value) -> Vec<String> {
        let scenes: Scenes = serde_json::from_value(serde_json::json!({
            "background_linear": 0.05, "environment_radiance_rgb": [0.25, 0.25, 0.25], "pictures": pictures,
            "grooms": { "g": {
                "scale_note": "1 unit is 1 m", "strand_file": "", "radius": { "root": 1, "tip": 1 }, "head_parts": [],
                "camera": { "origin": [0, 0, 0], "target": [0, 0, 1], "vertical_fov_degrees": 30, "resolution": [1, 1] },
                "lights": {
                    "key": { "direction_to_light": [0, 1, 0], "irradiance_rgb": [1, 1, 1] },
                    "lamp": { "kind": "point", "position": [0, 1, 0], "intensity_rgb": [1, 1, 1] },
                },
            } },
        }))
        .unwrap();
        assert_eq!(scenes.grooms["g"].copies, [[0.0; 3]]);
        scenes.views(&[]).unwrap().iter().map(|view| view.name.to_owned()).collect()
    }

    #[test]
    fn images_with_all_lights_are_compared() {
        let names = complete(serde_json::json!({
            "sky": { "groom": "g", "material": "red", "lights": ["key"], "environment": true },
            "parts": { "groom": "g", "material": "red", "lights": ["key"], "per_light_files": ["parts_key.exr"] },
            "part": { "groom": "g", "material": "red", "lights": ["key"] },
            "near": { "groom": "g", "material": "red", "lights": ["lamp"], "all_lights": true },
        }));
        assert_eq!(names, ["near", "parts", "sky"]);
    }

    #[test]
    fn strand_paths_resolve_to_assets_or_the_description() {
        let folders = Folders { scenes: Path::new("ref/scenes.json"), assets: Some(Path::new("assets")) };
        let mut groom = groom("");
        assert_eq!(groom.strands(&folders).unwrap(), Path::new("assets/a/b.tfx"));
        assert!(groom.strands(&Folders { assets: None, ..folders }).is_err());
        groom.strand_file = "geometry/c.tfx (float32)".into();
        assert_eq!(groom.strands(&folders).unwrap(), Path::new("ref/geometry/c.tfx"));
    }
}
