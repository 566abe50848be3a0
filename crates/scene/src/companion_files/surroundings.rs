//! Environment maps that light the scene.

use crate::{settings::LightSettings, shelf::Shelf};
use anyhow::{Context, Result, ensure};
use std::{io::Cursor, path::Path};
use tresses::{
    glam::Vec3,
    light::{Environment, Lights, Sky},
};

/// Maximum number of pixels in an image: 16K by 8K.
const MAX_PIXELS: u64 = 16_384 * 8_192;

/// Columns of the reduced image. More columns make no difference on hair.
const COLUMNS: usize = 512;

/// Equirectangular environment map in linear color, reduced in size. The face (+Z) looks at its center.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl EnvironmentMap {
    /// Reads the .hdr or .exr image at `path`.
    ///
    /// # Errors
    /// Fails if the image cannot be read or is not twice as wide as high. The message names the file.
    pub fn read(path: &Path, files: &Shelf) -> Result<Self> {
        let bytes = files.load(path)?;
        decode(path, &bytes).with_context(|| path.display().to_string())
    }

    /// Returns the lights of the map, with the rotation and strength from `settings`.
    pub fn lights(&self, settings: &LightSettings) -> Lights {
        let (rotation, strength) = (settings.environment_rotation, settings.environment_strength);
        // `decode` rejects empty images.
        let (mut environment, mut list) =
            Environment::from_equirectangular(self.width, self.height, &self.pixels, rotation)
                .unwrap_or_default();
        for coefficient in &mut environment.coefficients {
            *coefficient *= strength;
        }
        list.iter_mut().for_each(|sun| sun.intensity = strength);
        Lights { list, sky: Sky::default(), environment }
    }
}

fn decode(path: &Path, bytes: &[u8]) -> Result<EnvironmentMap> {
    let format = image::ImageFormat::from_path(path).ok();
    let format =
        format.filter(|format| matches!(format, image::ImageFormat::Hdr | image::ImageFormat::OpenExr));
    let format = format.context("environment maps are read from .hdr and .exr files")?;
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_PIXELS * 16);
    reader.limits(limits);
    let picture = reader.decode()?.into_rgb32f();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    ensure!(
        width > 0 && width.abs_diff(2 * height) <= 2,
        "the image is {width} × {height} pixels, but an equirectangular map is twice as wide as high"
    );
    // Average whole blocks, so that every pixel counts.
    let block = width.div_ceil(COLUMNS);
    let (columns, rows) = (width.div_ceil(block), height.div_ceil(block));
    let pixels = (0..rows * columns).map(|i| {
        let (x0, y0) = (i % columns * block, i / columns * block);
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for y in y0..(y0 + block).min(height) {
            for x in x0..(x0 + block).min(width) {
                let v = Vec3::from(picture.get_pixel(x as u32, y as u32).0);
                sum += if v.is_finite() { v.max(Vec3::ZERO) } else { Vec3::ZERO };
                count += 1.0;
            }
        }
        (sum / count).to_array()
    });
    Ok(EnvironmentMap { width: columns, height: rows, pixels: pixels.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::glam::Quat;

    /// Returns a shelf with an environment map: bright above, dark below, with a sun.
    fn written(name: &str, width: u32, height: u32) -> Shelf {
        let picture = image::Rgb32FImage::from_fn(width, height, |x, y| match (x, y) {
            (10..12, 5..7) => image::Rgb([800.0, 700.0, 600.0]),
            _ if y < height / 2 => image::Rgb([0.5, 0.6, 0.8]),
            _ => image::Rgb([0.1; 3]),
        });
        let mut bytes = Cursor::new(Vec::new());
        let format = image::ImageFormat::from_path(name).unwrap();
        image::DynamicImage::from(picture).write_to(&mut bytes, format).unwrap();
        let mut shelf = Shelf::default();
        shelf.put(name.into(), bytes.into_inner());
        shelf
    }

    #[test]
    fn hdr_and_exr_load() {
        for name in ["sky.hdr", "sky.exr"] {
            let read = EnvironmentMap::read(Path::new(name), &written(name, 64, 32)).unwrap();
            let usual = LightSettings::default();
            let lights = read.lights(&usual);
            assert_eq!(lights.active().count(), 1, "{name}");
            let (above, below) = (lights.environment.around(Vec3::Y), lights.environment.around(Vec3::NEG_Y));
            assert!((above - Vec3::new(0.5, 0.6, 0.8)).abs().max_element() < 0.05, "{name} {above}");
            assert!(below.x < 0.15);
            let brighter = read.lights(&LightSettings { environment_strength: 2.0, ..usual.clone() });
            assert!((brighter.environment.around(Vec3::Y) / above - 2.0).abs().max_element() < 1e-3);
            assert!(brighter.list[0].strength().x > 1.9 * lights.list[0].strength().x);
            let turned = read.lights(&LightSettings { environment_rotation: 1.0, ..usual });
            let [before, after] = [&lights, &turned].map(|lights| lights.list[0].irradiance_at(Vec3::ZERO).0);
            let expected = Quat::from_rotation_y(1.0) * before;
            assert!(after.angle_between(expected) < 0.05, "{before} {after}");
        }
    }

    #[test]
    fn invalid_environment_maps_fail() {
        let read = |name: &str, shelf: &Shelf| match EnvironmentMap::read(Path::new(name), shelf) {
            Ok(_) => panic!("{name}"),
            Err(error) => format!("{error:#}"),
        };
        assert!(read("square.hdr", &written("square.hdr", 64, 64)).contains("twice as wide"));
        assert!(read("missing.hdr", &Shelf::default()).contains("missing.hdr"));
        let mut shelf = Shelf::default();
        shelf.put("map.png".into(), *b"x");
        shelf.put("broken.exr".into(), *b"x");
        assert!(read("map.png", &shelf).contains(".hdr and .exr"));
        assert!(read("broken.exr", &shelf).contains("broken.exr"));
    }
}
