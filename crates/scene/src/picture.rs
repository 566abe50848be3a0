//! Rendered images and animations, encoded as files in memory. Used by the command line and by the studio's downloads.

mod animation;

pub use animation::{AnimationEncoder, AnimationFormat};

use anyhow::Result;
pub use tresses::groom::srgb::encoded;
use tresses::groom::srgb::linear;

/// An sRGB image, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Red, green, blue and alpha, one byte each.
    pub rgba: Vec<u8>,
}

impl Image {
    /// Encodes the image as PNG without alpha.
    ///
    /// # Errors
    /// Fails if the number of bytes does not match the size.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.encoded(png::ColorType::Rgb, &self.rgb())
    }

    /// Encodes the image as PNG with alpha. PNG stores straight alpha, so the linear colors, premultiplied in the
    /// image, are divided by alpha.
    ///
    /// # Errors
    /// Fails if the number of bytes does not match the size.
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

    /// Returns the pixels without alpha, three bytes each.
    pub fn rgb(&self) -> Vec<u8> {
        self.rgba.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
    }
}

/// Divides a color by its alpha in linear space. Returns zero for zero alpha.
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
    fn straight_alpha_restores_brightness() {
        let half = encoded(0.5 * linear(200.0 / 255.0));
        let [r, g, b, a] = straight([(255.0 * half + 0.5) as u8, 0, 255, 128]);
        assert!(r.abs_diff(200) <= 1 && (g, b, a) == (0, 255, 128), "{r}");
        assert_eq!(straight([90, 80, 70, 255]), [90, 80, 70, 255]);
        assert_eq!(straight([9, 9, 9, 0]), [0; 4]);
        let picture = Image { width: 2, height: 1, rgba: vec![90, 80, 70, 255, 0, 0, 0, 0] };
        let bytes = picture.png_with_alpha().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, picture.rgba);
    }
}
