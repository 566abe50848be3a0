//! Differences between two images.

use crate::picture::Image;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};
use serde::Serialize;

/// Mean FLIP difference (Andersson et al. 2020): 0 for equal and 1 for opposite images, at 67 pixels per degree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Mean of all pixels.
    pub picture: f64,
    /// Mean of the hair pixels.
    pub hair: f64,
}

/// Linear radiance.
pub struct Linear {
    /// Pixels per row.
    pub width: u32,
    /// Rows from the top, linear RGB.
    pub pixels: Vec<[f32; 3]>,
}

impl Linear {
    /// Returns width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.pixels.len() as u32 / self.width.max(1))
    }

    /// Returns the Rec. 709 luminance.
    pub fn luminance(&self, pixel: usize) -> f64 {
        let [r, g, b] = self.pixels[pixel].map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }
}

/// Returns the indices of pixels whose mask value exceeds one half.
pub fn hair(mask: &Image) -> impl Iterator<Item = usize> {
    mask.rgba.as_chunks::<4>().0.iter().enumerate().filter(|(_, rgba)| rgba[0] > 127).map(|(i, _)| i)
}

/// Returns the mean, 0 without values.
pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count.max(1))
}

/// Returns the difference of `test` from `reference`, and an image of it.
pub fn flip(reference: &Image, test: &Image, mask: &Image) -> (Difference, Image) {
    let (width, height) = (reference.width, reference.height);
    let image = |picture: &Image| FlipImageRgb8::with_data(width, height, &picture.rgb());
    let errors = nv_flip::flip(image(reference), image(test), DEFAULT_PIXELS_PER_DEGREE);
    let map = errors.apply_color_lut(&nv_flip::magma_lut()).to_vec();
    let rgba = map.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect();
    let errors = errors.to_vec();
    let difference = Difference {
        picture: mean(errors.iter().map(|e| f64::from(*e))),
        hair: mean(hair(mask).map(|i| f64::from(errors[i]))),
    };
    (difference, Image { width, height, rgba })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(left: u8, right: u8) -> Image {
        let (width, height) = (64, 32);
        let gray = |x| if x < 32 { left } else { right };
        let rgba =
            (0..height).flat_map(|_| (0..width).flat_map(|x| [gray(x), gray(x), gray(x), 255])).collect();
        Image { width, height, rgba }
    }

    #[test]
    fn flip_is_zero_only_for_equal_images() {
        let mask = flat(255, 0);
        let (same, _) = flip(&flat(90, 90), &flat(90, 90), &mask);
        assert_eq!(same, Difference { picture: 0.0, hair: 0.0 });
        let (left, map) = flip(&flat(90, 90), &flat(140, 90), &mask);
        assert!(left.hair > 0.05 && left.hair > 1.5 * left.picture, "{left:?}");
        assert_eq!((map.width, map.height), (64, 32));
        let (right, _) = flip(&flat(90, 90), &flat(90, 140), &mask);
        assert!(right.hair < 0.3 * left.hair, "{right:?} {left:?}");
        let (opposite, _) = flip(&flat(0, 0), &flat(255, 255), &mask);
        assert!(opposite.picture > 0.9, "{opposite:?}");
    }
}
