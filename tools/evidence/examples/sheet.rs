//! Lays out images in a grid with a label under each. `tools/evidence/style-sheet` uses it for the images of
//! `docs/guide/look.md`.
//!
//! `cargo run -p tresses-evidence --example sheet -- OUT.webp COLUMNS LABEL=PICTURE.png ...`, or `... -- paint PATTERN
//! OUT.png` for an example color map.

use anyhow::{Context, Result, ensure};
use embedded_graphics::{
    Pixel,
    mono_font::{MonoTextStyle, iso_8859_1::FONT_9X15},
    pixelcolor::Rgb888,
    prelude::*,
    text::{Alignment, Text},
};
use std::{convert::Infallible, fs::File, io::BufReader, path::Path};
use webp_animation::{Encoder, EncoderOptions, EncodingConfig, EncodingType, LossyEncodingConfig};

/// Height of the label under each image, pixels.
const LINE: usize = 22;

/// Gap between images, pixels.
const GAP: usize = 3;

struct Picture {
    width: usize,
    height: usize,
    rgba: Vec<u8>,
}

fn read(path: &Path) -> Result<Picture> {
    let open = || -> Result<Picture> {
        let mut decoder = png::Decoder::new(BufReader::new(File::open(path)?));
        decoder.set_transformations(png::Transformations::ALPHA | png::Transformations::STRIP_16);
        let mut reader = decoder.read_info()?;
        let mut rgba = vec![0; reader.output_buffer_size().context("too large")?];
        let info = reader.next_frame(&mut rgba)?;
        ensure!(info.color_type == png::ColorType::Rgba, "not a color image");
        Ok(Picture { width: info.width as usize, height: info.height as usize, rgba })
    };
    open().with_context(|| path.display().to_string())
}

impl OriginDimensions for Picture {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Picture {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(at, color) in pixels {
            if self.bounding_box().contains(at) {
                let i = 4 * (at.y as usize * self.width + at.x as usize);
                self.rgba[i..i + 3].copy_from_slice(&[color.r(), color.g(), color.b()]);
            }
        }
        Ok(())
    }
}

/// Writes a color map of the scalp with the front at the top: `streaks`, `halves` or `halo`.
fn paint(pattern: &str, out: &str) -> Result<()> {
    const SIDE: usize = 256;
    let color = |x: f32, y: f32| -> Result<[u8; 3]> {
        let (brown, blond, red) = ([96, 62, 38], [214, 178, 118], [168, 44, 30]);
        Ok(match pattern {
            "streaks" if (40.0 * x).sin() > 0.55 => blond,
            "streaks" => brown,
            "halves" if x < 0.5 => red,
            "halves" => blond,
            // `y` is 1 at the front.
            "halo" if y > 0.62 => blond,
            "halo" => red,
            _ => anyhow::bail!("{pattern}: choose streaks, halves or halo"),
        })
    };
    let mut pixels = Vec::with_capacity(3 * SIDE * SIDE);
    for i in 0..SIDE * SIDE {
        let at = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        pixels.extend(color(at(i % SIDE), 1.0 - at(i / SIDE))?);
    }
    let mut encoder = png::Encoder::new(File::create(out)?, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if let [word, pattern, out] = &args[..]
        && word == "paint"
    {
        return paint(pattern, out);
    }
    let [out, columns, cells @ ..] = &args[..] else {
        anyhow::bail!("expected OUT.webp COLUMNS LABEL=IMAGE.png ..., or paint PATTERN OUT.png");
    };
    let columns: usize = columns.parse().context("the number of columns")?;
    ensure!(columns > 0 && !cells.is_empty(), "expected at least one column and one image");
    let cells: Vec<(&str, Picture)> = cells
        .iter()
        .map(|cell| {
            // A label may contain an equals sign.
            let (label, path) = cell.rsplit_once('=').context("expected LABEL=IMAGE.png")?;
            Ok((label, read(Path::new(path))?))
        })
        .collect::<Result<_>>()?;
    let wide = cells.iter().map(|(_, p)| p.width).max().unwrap_or(0);
    let high = cells.iter().map(|(_, p)| p.height).max().unwrap_or(0) + LINE;
    let rows = cells.len().div_ceil(columns);
    let (width, height) = (columns * (wide + GAP) - GAP, rows * (high + GAP) - GAP);
    let mut sheet = Picture { width, height, rgba: [250u8, 250, 250, 255].repeat(width * height) };
    let style = MonoTextStyle::new(&FONT_9X15, Rgb888::new(30, 30, 30));
    for (i, (label, picture)) in cells.iter().enumerate() {
        let (x, y) = ((i % columns) * (wide + GAP), (i / columns) * (high + GAP));
        for (row, line) in picture.rgba.chunks_exact(4 * picture.width).enumerate() {
            let at = 4 * ((y + row) * width + x);
            sheet.rgba[at..at + line.len()].copy_from_slice(line);
        }
        let at = Point::new((x + wide / 2) as i32, (y + high - 7) as i32);
        let Ok(_) = Text::with_alignment(label, at, style, Alignment::Center).draw(&mut sheet);
    }
    if out.ends_with(".png") {
        let mut encoder = png::Encoder::new(File::create(out)?, width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgba);
        encoder.write_header()?.write_image_data(&sheet.rgba)?;
        return Ok(());
    }
    let lossy = EncodingConfig {
        encoding_type: EncodingType::Lossy(LossyEncodingConfig::default()),
        quality: 82.0,
        method: 6,
    };
    let options = EncoderOptions { encoding_config: Some(lossy), ..Default::default() };
    let mut encoder = Encoder::new_with_options((width as u32, height as u32), options)?;
    encoder.add_frame(&sheet.rgba, 0)?;
    std::fs::write(out, &*encoder.finalize(1)?).with_context(|| out.clone())?;
    println!("{out} ({width} × {height})");
    Ok(())
}
