//! Luminance statistics of an image of hair: mean, distribution from the darkest to the brightest pixels, contrast
//! between strands, and the skin next to the hair.

use super::{
    metrics::{Linear, hair, mean},
    scenes::Reference,
};
use crate::picture::Image;
use serde::Serialize;

/// Edge length of the square that a pixel is compared with for contrast, pixels.
const FINER: usize = 5;

/// Statistics of one image.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tones {
    /// Mean linear radiance of the hair pixels.
    pub rgb: [f64; 3],
    /// Mean luminance of the hair pixels.
    pub luminance: f64,
    /// Mean luminance of each tenth of the hair pixels, from the darkest to the brightest.
    pub tenths: [f64; 10],
    /// Contrast of fine detail: root mean square of the differences between the luminance of pixels and the mean of the
    /// 5 × 5 pixels around them, divided by the mean luminance. Only pixels surrounded by hair count. `None` if the
    /// image noise is unknown or exceeds the contrast.
    pub contrast: Option<f64>,
    /// Mean luminance of pixels with skin and no hair, if there are any.
    pub skin: Option<f64>,
}

/// Regions of an image.
pub struct Regions {
    /// Indices of pixels that are mostly hair.
    hair: Vec<usize>,
    /// Indices of those whose 5 × 5 neighborhood is all hair.
    amid: Vec<usize>,
    skin: Vec<usize>,
    width: usize,
}

impl Regions {
    /// Creates the regions from the hair mask (more than half of a pixel) and the coverage of `reference`.
    pub fn new(mask: &Image, reference: &Reference) -> Self {
        let (width, height) = (mask.width as usize, mask.height as usize);
        let hair_coverage: Vec<u8> = mask.rgba.as_chunks::<4>().0.iter().map(|rgba| rgba[0]).collect();
        let hair: Vec<usize> = hair(mask).collect();
        let radius = FINER / 2;
        let is_amid = |pixel: &usize| {
            let (x, y) = (pixel % width, pixel / width);
            let inside = x >= radius && y >= radius && x + radius < width && y + radius < height;
            inside && around(*pixel, width).all(|other| hair_coverage[other] > 127)
        };
        let amid = hair.iter().copied().filter(is_amid).collect();
        let skin = (0..hair_coverage.len())
            .filter(|i| hair_coverage[*i] == 0 && reference.alpha[*i] > 0.99)
            .collect();
        Self { hair, amid, skin, width }
    }
}

/// Returns the 5 × 5 pixels around one.
fn around(pixel: usize, width: usize) -> impl Iterator<Item = usize> {
    let radius = FINER / 2;
    let first = pixel - radius * width - radius;
    (0..FINER * FINER).map(move |i| first + i / FINER * width + i % FINER)
}

impl Tones {
    /// Computes the statistics of `picture`. `noise` is its root-mean-square error relative to the radiance, if known.
    pub fn new(picture: &Linear, of: &Regions, noise: Option<f64>) -> Self {
        let light = |pixel: &usize| picture.luminance(*pixel);
        let mut sorted: Vec<f64> = of.hair.iter().map(light).collect();
        sorted.sort_by(f64::total_cmp);
        let tenth = |i: usize| {
            let [from, to] = [i, i + 1].map(|i| i * sorted.len() / 10);
            mean(sorted[from..to].iter().copied())
        };
        let luminance = mean(sorted.iter().copied());
        let finer = |pixel: &usize| {
            let near = around(*pixel, of.width).map(|other| picture.luminance(other)).sum::<f64>();
            (light(pixel) - near / (FINER * FINER) as f64).powi(2)
        };
        let contrast = |noise: f64| {
            // Noise is independent per pixel, so all of it except its part in the mean counts as fine detail.
            let noise = (noise * luminance).powi(2) * (1.0 - 1.0 / (FINER * FINER) as f64);
            let fine = mean(of.amid.iter().map(finer)) - noise;
            (fine >= 0.0 && !of.amid.is_empty()).then(|| fine.sqrt() / luminance.max(1e-12))
        };
        Self {
            rgb: [0, 1, 2].map(|c| mean(of.hair.iter().map(|i| f64::from(picture.pixels[*i][c])))),
            luminance,
            tenths: std::array::from_fn(tenth),
            contrast: noise.and_then(contrast),
            skin: (!of.skin.is_empty()).then(|| mean(of.skin.iter().map(light))),
        }
    }

    /// Returns the ratios to `other`, where that is not black: hair, its darkest and its brightest tenth, contrast,
    /// skin.
    pub fn over(&self, other: &Self) -> [Option<f64>; 5] {
        let min_luminance = 1e-4 * other.luminance;
        let lit = |own: f64, other: f64| (other > min_luminance).then(|| own / other);
        let both = |own: Option<f64>, other: Option<f64>| lit(own?, other?);
        [
            lit(self.luminance, other.luminance),
            lit(self.tenths[0], other.tenths[0]),
            lit(self.tenths[9], other.tenths[9]),
            both(self.contrast, other.contrast),
            both(self.skin, other.skin),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 40;

    /// Hair in the columns on the left, skin on the right.
    fn regions() -> Regions {
        let rgba = (0..WIDTH * WIDTH).flat_map(|i| [if i % WIDTH < 30 { 255 } else { 0 }; 4]).collect();
        let mask = Image { width: WIDTH as u32, height: WIDTH as u32, rgba };
        let alpha = vec![1.0; WIDTH * WIDTH];
        Regions::new(&mask, &Reference { linear: picture(|_| 0.0), alpha })
    }

    fn picture(light: impl Fn(usize) -> f32) -> Linear {
        Linear { width: WIDTH as u32, pixels: (0..WIDTH * WIDTH).map(|i| [light(i % WIDTH); 3]).collect() }
    }

    #[test]
    fn tones_separate_hair_and_skin() {
        let of = regions();
        // Three tenths of the hair are bright, and the skin is brighter.
        let found = Tones::new(
            &picture(|x| [1.0, 3.0, 7.0][usize::from(x >= 21) + usize::from(x >= 30)]),
            &of,
            Some(0.0),
        );
        assert!(
            (found.luminance - 1.6).abs() < 1e-6 && found.skin.is_some_and(|skin| (skin - 7.0).abs() < 1e-6),
            "{found:?}"
        );
        let expected = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0];
        assert!(
            found.tenths.iter().zip(expected).all(|(is, should)| (is - should).abs() < 1e-6),
            "{found:?}"
        );
        assert!(found.rgb.iter().all(|channel| (channel - 1.6).abs() < 1e-6));
        let doubled = Tones::new(
            &picture(|x| [2.0, 6.0, 7.0][usize::from(x >= 21) + usize::from(x >= 30)]),
            &of,
            Some(0.0),
        );
        let ratios = doubled.over(&found);
        let right = [2.0, 2.0, 2.0, 1.0, 1.0];
        let is = |(is, should): (&Option<f64>, f64)| is.is_some_and(|is| (is - should).abs() < 1e-6);
        assert!(ratios.iter().zip(right).all(is), "{ratios:?}");
        // No ratios to a black image.
        let dark = Tones::new(&picture(|_| 0.0), &of, Some(0.0));
        assert_eq!(found.over(&dark), [None; 5]);
    }

    #[test]
    fn contrast_excludes_slopes_and_noise() {
        let of = regions();
        // Strands one pixel wide, alternately half brighter and half darker than the mean.
        let strands = Tones::new(&picture(|x| 1.0 + 0.5 * (1.0 - 2.0 * (x % 2) as f32)), &of, Some(0.0));
        assert!((strands.contrast.unwrap() - 0.5).abs() < 0.11, "{strands:?}");
        let slope = Tones::new(&picture(|x| 1.0 + 0.02 * x as f32), &of, Some(0.0));
        assert!(slope.contrast.unwrap() < 1e-6, "{slope:?}");
        // Noise below the fine detail leaves the rest, noise above it leaves nothing, and unknown noise gives no
        // result.
        let noisy = |noise: Option<f64>| {
            Tones::new(&picture(|x| 1.0 + 0.5 * (1.0 - 2.0 * (x % 2) as f32)), &of, noise).contrast
        };
        let all = strands.contrast.unwrap() / (24.0_f64 / 25.0).sqrt();
        assert!(
            noisy(Some(0.9 * all)).is_some_and(|left| left > 0.1 && left < 0.3),
            "{:?}",
            noisy(Some(0.9 * all))
        );
        assert_eq!((noisy(Some(1.01 * all)), noisy(None)), (None, None));
    }
}
