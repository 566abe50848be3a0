//! Legend of a debug view: a color bar with numbers, drawn into the image.

use crate::picture::Image;
use embedded_graphics::{
    Pixel,
    mono_font::{MonoFont, MonoTextStyle, iso_8859_1},
    pixelcolor::Rgb888,
    prelude::*,
    primitives::Rectangle,
    text::{Alignment, Text},
};
use std::convert::Infallible;
use tresses::low_level::ramp;
use tresses_scene::picture::encoded;

/// Meaning of the colors.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Quantity and unit.
    pub title: String,
    /// Value of the darkest color.
    pub min: f32,
    /// Value of the brightest color.
    pub max: f32,
}

/// Draw target that clips to the image.
struct Canvas<'a>(&'a mut Image);

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.0.width, self.0.height)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(at, color) in pixels {
            if self.bounding_box().contains(at) {
                let i = 4 * (at.y as usize * self.0.width as usize + at.x as usize);
                self.0.rgba[i..i + 4].copy_from_slice(&[color.r(), color.g(), color.b(), 255]);
            }
        }
        Ok(())
    }
}

impl Legend {
    /// Draws the legend into the lower left corner, unless the image is too small.
    pub fn draw(&self, picture: &mut Image) {
        let font = font(picture);
        let (wide, high) = (font.character_size.width as i32, font.character_size.height as i32);
        let bar = Size::new(24 * wide as u32, (high / 2) as u32);
        let at = Point::new(2 * wide, picture.height as i32 - 2 * wide - 3 * high);
        if picture.width < bar.width + 6 * wide as u32 || at.y < high {
            return;
        }
        let mut canvas = Canvas(picture);
        let mut text = |words: &str, x: i32, y: i32, alignment| {
            write(&mut canvas, font, words, at + Point::new(x, y), alignment);
        };
        let (end, below) = (bar.width as i32, high / 2 + high + high / 4);
        text(&self.title, 0, -high / 2, Alignment::Left);
        for (x, value) in [(0, self.min), (end / 2, 0.5 * (self.min + self.max)), (end, self.max)] {
            text(&number(value), x, below, Alignment::Center);
        }
        let column = Size::new(1, bar.height);
        for x in 0..end {
            let color = srgb(ramp((x as f32 + 0.5) / end as f32).to_array());
            let Ok(()) = canvas.fill_solid(&Rectangle::new(at + Point::new(x, 0), column), color);
        }
    }
}

/// Returns a font that suits the image height.
fn font(picture: &Image) -> &'static MonoFont<'static> {
    if picture.height >= 400 { &iso_8859_1::FONT_10X20 } else { &iso_8859_1::FONT_6X10 }
}

/// Writes white text with a shadow, legible on any background. `at` is on the baseline.
fn write(canvas: &mut Canvas<'_>, font: &MonoFont<'_>, words: &str, at: Point, alignment: Alignment) {
    for (color, shift) in [(Rgb888::BLACK, 1), (Rgb888::WHITE, 0)] {
        let style = MonoTextStyle::new(font, color);
        let Ok(_) = Text::with_alignment(words, at + Point::new(shift, shift), style, alignment).draw(canvas);
    }
}

/// Writes text below and to the right of `at`, pixels. Small images get none.
pub fn caption(picture: &mut Image, words: &str, at: [i32; 2]) {
    let font = font(picture);
    if picture.height >= 200 {
        let position = Point::new(at[0] + 6, at[1] + 3 + font.character_size.height as i32 * 3 / 4);
        write(&mut Canvas(picture), font, words, position, Alignment::Left);
    }
}

/// Converts a linear color.
fn srgb(color: [f32; 3]) -> Rgb888 {
    let [r, g, b] = color.map(|c| (encoded(c.clamp(0.0, 1.0)) * 255.0).round() as u8);
    Rgb888::new(r, g, b)
}

/// Formats a number with at most three significant digits.
fn number(value: f32) -> String {
    match value.abs() {
        0.0 => "0".into(),
        x if !(1e-3..1e5).contains(&x) => format!("{value:.1e}"),
        _ => {
            let digits = (2 - value.abs().log10().floor() as i32).max(0) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
        }
    }
}

/// Rounds up to 1, 2 or 5 times a power of ten. Returns 1 for values out of range.
pub fn rounded_up(value: f32) -> f32 {
    if value.is_nan() || value <= 1e-20 || value > 1e20 {
        return 1.0;
    }
    let power = 10f32.powi(value.log10().floor() as i32);
    let up = [1.0, 2.0, 5.0, 10.0].map(|x| x * power);
    // Tolerate values slightly above a round number.
    up.into_iter().find(|x| value <= x * 1.001).unwrap_or(up[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases =
            [(0.0, "0"), (2.5, "2.5"), (0.125, "0.125"), (5000.0, "5000"), (100.0, "100"), (1e7, "1.0e7")];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn scale_ends_are_round() {
        for (value, up) in [(3.1, 5.0), (0.013, 0.02), (700.0, 1000.0), (2.0, 2.0), (10.0, 10.0)] {
            assert!((rounded_up(value) / up - 1.0).abs() < 1e-5, "{value}: {}", rounded_up(value));
        }
        assert_eq!([0.0, f32::NAN, f32::INFINITY].map(rounded_up), [1.0; 3]);
    }

    #[test]
    fn legend_is_drawn_if_it_fits() {
        let legend = Legend { title: "speed, m/s".into(), min: 0.0, max: 2.0 };
        let blank = |width, height| Image { width, height, rgba: vec![100; (width * height * 4) as usize] };
        for (width, height) in [(640, 480), (320, 200)] {
            let mut picture = blank(width, height);
            legend.draw(&mut picture);
            let changed = |x: std::ops::Range<u32>, y: std::ops::Range<u32>| {
                let place = |x: u32, y: u32| (4 * (y * width + x)) as usize;
                y.flat_map(|y| x.clone().map(move |x| (x, y)))
                    .filter(|(x, y)| picture.rgba[place(*x, *y)] != 100)
                    .count()
            };
            assert!(changed(0..width / 2, height / 2..height) > 500);
            assert_eq!(changed(width / 2 + width / 4..width, 0..height), 0);
            assert_eq!(changed(0..width, 0..height / 2), 0);
        }
        let mut small = blank(64, 40);
        legend.draw(&mut small);
        assert_eq!(small, blank(64, 40));
    }
}
