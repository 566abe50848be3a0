//! Finished pictures, and animations of them as the bytes of one file: for the command's files and the
//! studio's downloads alike.

mod animation;

pub use animation::{Animation, Format};

use anyhow::Result;
pub use tresses::groom::srgb::encoded;
use tresses::groom::srgb::linear;

/// Pixels from top left, row by row, sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Four bytes per pixel: red, green, blue, alpha.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// As the bytes of a PNG file without alpha.
    ///
    /// # Errors
    /// When there are not as many bytes as pixels.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.encoded(png::ColorType::Rgb, &self.rgb())
    }

    /// As the bytes of a PNG file with alpha: colours, which the picture has multiplied by alpha before they were encoded,
    /// are divided by it, as PNG has it.
    ///
    /// # Errors
    /// When there are not as many bytes as pixels.
    pub fn png_with_alpha(&self) -> Result<Vec<u8>> {
        let straight: Vec<u8> = self.rgba.as_chunks().0.iter().copied().flat_map(straight).collect();
        self.encoded(png::ColorType::Rgba, &straight)
    }

    fn encoded(&self, color: png::ColorType, data: &[u8]) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(color);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(data)?;
        writer.finish()?;
        Ok(bytes)
    }

    /// Without alpha: three bytes per pixel.
    pub fn rgb(&self) -> Vec<u8> {
        self.rgba.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
    }
}

/// A colour whose light is divided by its alpha; none where there is none.
fn straight([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    let alpha = f32::from(a) / 255.0;
    let divided = |v: u8| {
        let light = linear(f32::from(v) / 255.0) / alpha.max(1e-6);
        (255.0 * encoded(light.min(1.0)) + 0.5) as u8
    };
    if a == 0 { [0; 4] } else { [divided(r), divided(g), divided(b), a] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_half_there_is_as_bright_as_all_of_it() {
        let half = encoded(0.5 * linear(200.0 / 255.0));
        let [r, g, b, a] = straight([(255.0 * half + 0.5) as u8, 0, 255, 128]);
        assert!(r.abs_diff(200) <= 1 && (g, b, a) == (0, 255, 128), "{r}");
        assert_eq!(straight([90, 80, 70, 255]), [90, 80, 70, 255]);
        assert_eq!(straight([9, 9, 9, 0]), [0; 4]);
        let picture = Picture { width: 2, height: 1, rgba: vec![90, 80, 70, 255, 0, 0, 0, 0] };
        let bytes = picture.png_with_alpha().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, picture.rgba);
    }
}
