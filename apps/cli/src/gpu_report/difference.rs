//! Difference of two images, in levels of 8 bits.

use crate::{bench::statistics::percentile, picture::Image};

/// Brightness of a difference of one level in the image of differences.
const GAIN: f64 = 8.0;

/// Difference of two images.
pub struct ImageDifference {
    /// Mean of the pixels, levels. The difference of a pixel is the mean of its three channels.
    pub mean: f64,
    /// 99th percentile of the pixels, levels.
    pub p99: f64,
    /// The differences as gray, multiplied by 8.
    pub image: Image,
}

/// Returns the difference of `a` and `b`, or `None` if their sizes differ.
pub fn difference(a: &Image, b: &Image) -> Option<ImageDifference> {
    if (a.width, a.height) != (b.width, b.height) || a.rgba.len() != b.rgba.len() {
        return None;
    }
    let pixel =
        |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|i| f64::from(a[i].abs_diff(b[i]))).sum::<f64>() / 3.0;
    let mut levels: Vec<f64> = a.rgba.as_chunks().0.iter().zip(b.rgba.as_chunks().0).map(pixel).collect();
    let gray = |level: &f64| {
        let value = (GAIN * level).round().min(255.0) as u8;
        [value, value, value, 255]
    };
    let image = Image { width: a.width, height: a.height, rgba: levels.iter().flat_map(gray).collect() };
    let mean = levels.iter().sum::<f64>() / levels.len().max(1) as f64;
    levels.sort_by(f64::total_cmp);
    Some(ImageDifference { mean, p99: percentile(&levels, 0.99), image })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_percentile_of_a_difference() {
        let image = |level: u8, count: usize| {
            let rgba = (0..200).flat_map(|i| [if i < count { level } else { 0 }, 0, 0, 255]).collect();
            Image { width: 20, height: 10, rgba }
        };
        let found = difference(&image(30, 0), &image(30, 20)).unwrap();
        assert_eq!((found.mean, found.p99), (1.0, 10.0));
        assert_eq!(&found.image.rgba[..4], &[80, 80, 80, 255]);
        let none = difference(&image(9, 9), &image(9, 9)).unwrap();
        assert_eq!((none.mean, none.p99), (0.0, 0.0));
        let other = Image { width: 10, height: 20, ..image(0, 0) };
        assert!(difference(&image(0, 0), &other).is_none());
    }
}
