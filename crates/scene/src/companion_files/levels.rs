//! Files of painted levels of detail.

use super::MapSource;
use crate::shelf::Shelf;
use anyhow::{Context, Error, Result};
use serde::Deserialize;
use std::path::Path;
use tresses::LodLevel;

/// A file of painted levels.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    levels: Vec<Level>,
}

/// One level: names of maps, or images relative to the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Level {
    /// Screen size of the hair, pixels.
    size: f32,
    density: Option<String>,
    thickness: Option<String>,
}

/// Reads painted levels of detail from the .json file at `path`. In density maps, black draws no strand and white all.
/// In thickness maps, black draws a quarter of the width, middle gray the original width, and white four times the
/// width.
///
/// # Errors
/// Fails if the file or an image that it names cannot be read. The message names the file.
pub fn levels(path: &Path, files: &Shelf) -> Result<Vec<LodLevel>> {
    let text = files.load(path)?;
    let read = || -> Result<Vec<LodLevel>> {
        let file: File = serde_json::from_slice(&text)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let map = |name: &Option<String>, value: &dyn Fn(f32) -> f32| {
            let read = |name: &String| {
                let source = match name.parse().map_err(Error::msg)? {
                    MapSource::Picture(path, channel) => MapSource::Picture(folder.join(path), channel),
                    named => named,
                };
                anyhow::Ok(source.read(files)?.map(value))
            };
            name.as_ref().map(read).transpose()
        };
        file.levels
            .iter()
            .map(|level| {
                Ok(LodLevel {
                    size: level.size,
                    density: map(&level.density, &|gray| gray)?,
                    thickness: map(&level.thickness, &|gray| 4f32.powf(2.0 * gray - 1.0))?,
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
    fn levels_load_images_next_to_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let mut encoder =
            png::Encoder::new(std::fs::File::create(folder.path().join("d.png")).unwrap(), 1, 1);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[51]).unwrap();
        let path = folder.path().join("levels.json");
        let text = r#"{"levels": [{"size": 300}, {"size": 40, "density": "d.png", "thickness": "d.png"}]}"#;
        std::fs::write(&path, text).unwrap();
        let levels = |path: &Path| super::levels(path, &Shelf::default());
        let read = levels(&path).unwrap();
        assert_eq!((read.len(), &read[0].density), (2, &None));
        let at = |map: &Option<tresses::groom::scalp::ScalpMap>| {
            map.as_ref().unwrap().sample(tresses::glam::Vec2::splat(0.5))
        };
        assert!((at(&read[1].density) - 0.2).abs() < 1e-5);
        assert!((at(&read[1].thickness) - 4f32.powf(-0.6)).abs() < 1e-5);
        std::fs::write(&path, text.replace("d.png", "e.png")).unwrap();
        let error = format!("{:#}", levels(&path).unwrap_err());
        assert!(error.contains("levels.json") && error.contains("e.png"), "{error}");
        std::fs::write(&path, text.replace("size", "sise")).unwrap();
        assert!(levels(&path).is_err());
    }

    #[test]
    fn levels_load_from_memory() {
        let mut png = Vec::new();
        let mut encoder = png::Encoder::new(&mut png, 1, 1);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[255]).unwrap();
        let mut shelf = Shelf::default();
        shelf.put("levels.json".into(), *br#"{"levels": [{"size": 40, "density": "far/d.png"}]}"#);
        assert!(super::levels(Path::new("levels.json"), &shelf).is_err(), "its picture is not given");
        shelf.put("d.png".into(), png);
        let levels = super::levels(Path::new("levels.json"), &shelf).unwrap();
        assert!(levels[0].density.is_some());
    }
}
