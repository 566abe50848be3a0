//! Lays pictures out in a grid with a line of text under each: `scripts/style-sheet` makes the pictures
//! of `docs/appearance/style.md` with it.
//!
//! `cargo run -p tresses-cli --example sheet -- OUT.webp COLUMNS LABEL=PICTURE.png ...`

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

/// Height of the line under each picture, pixels.
const LINE: usize = 22;

/// Between pictures, pixels.
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
        ensure!(info.color_type == png::ColorType::Rgba, "not a picture in colour");
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

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [out, columns, cells @ ..] = &args[..] else {
        anyhow::bail!("give OUT.webp COLUMNS LABEL=PICTURE.png ...");
    };
    let columns: usize = columns.parse().context("the number of columns")?;
    ensure!(columns > 0 && !cells.is_empty(), "give at least one column and one picture");
    let cells: Vec<(&str, Picture)> = cells
        .iter()
        .map(|cell| {
            // A label may have an equals sign of its own.
            let (label, path) = cell.rsplit_once('=').context("give LABEL=PICTURE.png")?;
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
