//! What two pictures of the same hair have of light, each on its own: how much, how it is spread from the dimmest pixels
//! to the brightest, how crisp strands are, and how much the skin beside them has.

use super::{
    metrics::{Linear, hair, mean},
    scenes::Reference,
};
use crate::picture::Picture;
use serde::Serialize;

/// Edge of the squares whose mean is taken from a pixel for what is finer, pixels.
const FINER: usize = 5;

/// Of one picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tones {
    /// Mean linear radiance of the pixels of hair, by channel.
    pub rgb: [f64; 3],
    /// Their mean luminance.
    pub luminance: f64,
    /// Mean luminance of the dimmest tenth of them, and so on to the brightest.
    pub tenths: [f64; 10],
    /// How far the luminance of pixels amid hair is from the mean of the five by five around them, root mean square, over
    /// the mean luminance; not where nobody knows the noise, or where all that is fine is noise.
    pub contrast: Option<f64>,
    /// Mean luminance of the pixels that bodies fill and no hair touches, where there are some.
    pub skin: Option<f64>,
}

/// What of a picture is what.
pub struct Regions {
    /// The indices of pixels that are mostly hair.
    hair: Vec<usize>,
    /// Of those in whose five by five pixels all are hair.
    amid: Vec<usize>,
    skin: Vec<usize>,
    width: usize,
}

impl Regions {
    /// By the mask of the hair (more than half of a pixel), and what else `reference` covers.
    pub fn new(mask: &Picture, reference: &Reference) -> Self {
        let (width, height) = (mask.width as usize, mask.height as usize);
        let share: Vec<u8> = mask.rgba.as_chunks::<4>().0.iter().map(|rgba| rgba[0]).collect();
        let hair: Vec<usize> = hair(mask).collect();
        let reach = FINER / 2;
        let is_amid = |pixel: &usize| {
            let (x, y) = (pixel % width, pixel / width);
            let inside = x >= reach && y >= reach && x + reach < width && y + reach < height;
            inside && around(*pixel, width).all(|other| share[other] > 127)
        };
        let amid = hair.iter().copied().filter(is_amid).collect();
        let skin = (0..share.len()).filter(|i| share[*i] == 0 && reference.alpha[*i] > 0.99).collect();
        Self { hair, amid, skin, width }
    }
}

/// The five by five pixels around one.
fn around(pixel: usize, width: usize) -> impl Iterator<Item = usize> {
    let reach = FINER / 2;
    let first = pixel - reach * width - reach;
    (0..FINER * FINER).map(move |i| first + i / FINER * width + i % FINER)
}

impl Tones {
    /// Of `picture`, whose pixels are off by `noise` of their radiance, root mean square, if that is known.
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
            // Noise is none of a pixel's neighbours': all of it but what is in the mean is fine.
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

    /// Over those of `other`, where they have some light: hair, its dimmest and its brightest tenth, contrast, skin.
    pub fn over(&self, other: &Self) -> [Option<f64>; 5] {
        let least = 1e-4 * other.luminance;
        let lit = |own: f64, other: f64| (other > least).then(|| own / other);
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

    /// Columns of hair on the left, skin on the right.
    fn regions() -> Regions {
        let rgba = (0..WIDTH * WIDTH).flat_map(|i| [if i % WIDTH < 30 { 255 } else { 0 }; 4]).collect();
        let mask = Picture { width: WIDTH as u32, height: WIDTH as u32, rgba };
        let alpha = vec![1.0; WIDTH * WIDTH];
        Regions::new(&mask, &Reference { linear: picture(|_| 0.0), alpha })
    }

    fn picture(light: impl Fn(usize) -> f32) -> Linear {
        Linear { width: WIDTH as u32, pixels: (0..WIDTH * WIDTH).map(|i| [light(i % WIDTH); 3]).collect() }
    }

    #[test]
    fn each_part_of_a_picture_has_its_own_light() {
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
        // Nothing is told of what has no light.
        let dark = Tones::new(&picture(|_| 0.0), &of, Some(0.0));
        assert_eq!(found.over(&dark), [None; 5]);
    }

    #[test]
    fn contrast_is_of_what_is_fine_and_not_of_noise() {
        let of = regions();
        // Strands of a pixel, each other one half as bright again as the mean, or as dark.
        let strands = Tones::new(&picture(|x| 1.0 + 0.5 * (1.0 - 2.0 * (x % 2) as f32)), &of, Some(0.0));
        assert!((strands.contrast.unwrap() - 0.5).abs() < 0.11, "{strands:?}");
        let slope = Tones::new(&picture(|x| 1.0 + 0.02 * x as f32), &of, Some(0.0));
        assert!(slope.contrast.unwrap() < 1e-6, "{slope:?}");
        // Of noise that is part of what is fine the rest is left, of noise that is all of it nothing, and of unknown noise
        // nobody knows.
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
