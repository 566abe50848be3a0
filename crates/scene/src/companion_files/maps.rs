//! Scalp maps, from images or by name.

use crate::shelf::Shelf;
use anyhow::{Context, Result, bail};
use std::{
    io::Cursor,
    path::{Path, PathBuf},
    str::FromStr,
};
use tresses::groom::{grow::ColorMap, scalp::ScalpMap, srgb::linear};

/// Source of a scalp map's values.
#[derive(Clone, Debug, PartialEq)]
pub enum MapSource {
    /// A map built into the library.
    Named(String),
    /// An image and one of its channels; `None` averages the color channels.
    Picture(PathBuf, Option<usize>),
}

impl FromStr for MapSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if ScalpMap::NAMES.contains(&text.strip_prefix("not-").unwrap_or(text)) {
            return Ok(Self::Named(text.to_owned()));
        }
        let channel = text.rsplit_once(':').and_then(|(path, c)| match c {
            "r" => Some((path, 0)),
            "g" => Some((path, 1)),
            "b" => Some((path, 2)),
            _ => None,
        });
        let (path, channel) = channel.map_or((text, None), |(path, c)| (path, Some(c)));
        if !is_png(path) {
            return Err(format!("expected a .png file or one of {}", ScalpMap::NAMES.join(", ")));
        }
        Ok(Self::Picture(path.into(), channel))
    }
}

impl std::fmt::Display for MapSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Named(name) => f.write_str(name),
            Self::Picture(path, None) => path.display().fmt(f),
            Self::Picture(path, Some(channel)) => {
                write!(f, "{}:{}", path.display(), ["r", "g", "b"][*channel])
            }
        }
    }
}

impl MapSource {
    /// Reads the map, with values from 0 to 1. The image is looked up in `files`.
    ///
    /// # Errors
    /// Fails if the image cannot be read or lacks the channel. The message names the image.
    pub fn read(&self, files: &Shelf) -> Result<ScalpMap> {
        match self {
            Self::Named(name) => ScalpMap::named(name).with_context(|| format!("there is no map {name}")),
            Self::Picture(path, channel) => {
                let picture = Picture::read(path, files)?;
                if channel.is_some() && picture.channels == 1 {
                    bail!(
                        "{}: a grayscale image has no separate channels; remove :r, :g or :b",
                        path.display()
                    );
                }
                match channel {
                    Some(channel) => picture.map(|pixel| pixel[*channel]),
                    None => picture.map(|pixel| pixel.iter().sum::<f32>() / pixel.len() as f32),
                }
            }
        }
    }
}

/// A color image over the scalp.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorSource(PathBuf);

impl FromStr for ColorSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if is_png(text) { Ok(Self(text.into())) } else { Err("expected a .png file".into()) }
    }
}

impl std::fmt::Display for ColorSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.display().fmt(f)
    }
}

impl ColorSource {
    /// Reads the map, in linear color. The image is looked up in `files`.
    ///
    /// # Errors
    /// Fails if the image cannot be read. The message names the image.
    pub fn read(&self, files: &Shelf) -> Result<ColorMap> {
        let picture = Picture::read(&self.0, files)?;
        let channel = |c: usize| picture.map(|pixel| linear(pixel[c.min(pixel.len() - 1)]));
        Ok(ColorMap { channels: [channel(0)?, channel(1)?, channel(2)?] })
    }
}

fn is_png(path: &str) -> bool {
    Path::new(path).extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// An image in the row order of scalp maps: the bottom row, the back of the head, comes first.
struct Picture {
    width: usize,
    height: usize,
    /// Channels per pixel, 1 or 3.
    channels: usize,
    /// Channel values from 0 to 1, without alpha.
    values: Vec<f32>,
}

impl Picture {
    fn read(path: &Path, files: &Shelf) -> Result<Self> {
        // Errors of `load` already name the file.
        let file = files.load(path)?;
        let read = || -> Result<Self> {
            let mut decoder = png::Decoder::new(Cursor::new(&*file));
            // Expand palettes and low bit depths to 8 bits; 16-bit samples stay.
            decoder.set_transformations(png::Transformations::EXPAND);
            let mut reader = decoder.read_info()?;
            let size = reader.output_buffer_size().context("the image is too large")?;
            let mut bytes = vec![0; size];
            let info = reader.next_frame(&mut bytes)?;
            let (width, height) = (info.width as usize, info.height as usize);
            let samples = info.color_type.samples();
            let channels = if samples < 3 { 1 } else { 3 };
            let mut values = Vec::with_capacity(width * height * channels);
            for row in bytes[..info.buffer_size()].chunks_exact(info.line_size).rev() {
                let value = |i: usize| match info.bit_depth {
                    png::BitDepth::Sixteen => {
                        f32::from(u16::from_be_bytes([row[2 * i], row[2 * i + 1]])) / 65_535.0
                    }
                    _ => f32::from(row[i]) / 255.0,
                };
                values.extend(
                    (0..width)
                        .flat_map(|x| (0..channels).map(move |c| (x, c)))
                        .map(|(x, c)| value(x * samples + c)),
                );
            }
            Ok(Self { width, height, channels, values })
        };
        read().with_context(|| path.display().to_string())
    }

    fn map(&self, value: impl Fn(&[f32]) -> f32) -> Result<ScalpMap> {
        let values = self.values.chunks_exact(self.channels).map(value).collect();
        Ok(ScalpMap::new(self.width, self.height, values)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use tresses::glam::Vec2;

    /// Writes an image of 2 × 2 pixels; `bytes` holds its rows from the top.
    fn picture(
        folder: &Path,
        name: &str,
        color: png::ColorType,
        depth: png::BitDepth,
        bytes: &[u8],
    ) -> PathBuf {
        let path = folder.join(name);
        let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 2, 2);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
        path
    }

    fn corners(map: &ScalpMap) -> [f32; 4] {
        // Front right of the head, front left, back right, back left: the order of the image's pixels.
        [(0.0, 1.0), (1.0, 1.0), (0.0, 0.0), (1.0, 0.0)].map(|(u, v)| map.sample(Vec2::new(u, v)))
    }

    fn read(path: &Path, suffix: &str) -> Result<ScalpMap> {
        format!("{}{suffix}", path.display()).parse::<MapSource>().unwrap().read(&Shelf::default())
    }

    #[test]
    fn png_variants_load() {
        let folder = tempfile::tempdir().unwrap();
        let (gray, rgb) = (png::ColorType::Grayscale, png::ColorType::Rgb);
        let (eight, sixteen) = (png::BitDepth::Eight, png::BitDepth::Sixteen);
        let path = picture(folder.path(), "gray.png", gray, eight, &[0, 51, 102, 255]);
        let near = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near(corners(&read(&path, "").unwrap()), [0.0, 0.2, 0.4, 1.0]));
        assert!(read(&path, ":r").is_err());
        let path = picture(folder.path(), "fine.png", gray, sixteen, &[0, 0, 0, 1, 0x80, 0, 255, 255]);
        let fine = corners(&read(&path, "").unwrap());
        assert!((fine[1] * 65_535.0 - 1.0).abs() < 1e-3 && fine[3] == 1.0, "{fine:?}");
        let pixels = [[255u8, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]].concat();
        let path = picture(folder.path(), "color.PNG", rgb, eight, &pixels);
        assert_eq!(corners(&read(&path, ":r").unwrap()), [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(corners(&read(&path, ":g").unwrap()), [0.0, 1.0, 0.0, 1.0]);
        assert!((corners(&read(&path, "").unwrap())[0] - 1.0 / 3.0).abs() < 1e-6);
        let color =
            path.display().to_string().parse::<ColorSource>().unwrap().read(&Shelf::default()).unwrap();
        assert_eq!(color.sample(Vec2::ZERO).to_array(), [0.0, 0.0, 1.0]);
        std::fs::write(&path, "no picture").unwrap();
        let error = format!("{:#}", read(&path, "").unwrap_err());
        assert!(error.contains("color.PNG") && !error.contains('\n'), "{error}");
    }

    #[test]
    fn map_sources_parse_or_fail() {
        assert_eq!("not-front".parse(), Ok(MapSource::Named("not-front".into())));
        assert!("front".parse::<MapSource>().unwrap().read(&Shelf::default()).is_ok());
        for text in ["not-front", "map.png", "deep/map.png:g"] {
            assert_eq!(text.parse::<MapSource>().unwrap().to_string(), text);
        }
        for text in ["", "top", "map.jpg", "map.png:a", "not-map"] {
            assert!(text.parse::<MapSource>().is_err(), "{text}");
        }
        assert!("noise".parse::<ColorSource>().is_err());
    }
}
