//! Fraction of the light that reaches visible hair: single-scattered light with shadows, divided by the same without
//! shadows.

use super::metrics::{Linear, hair};
use crate::picture::Image;
use serde::Serialize;
use std::collections::BTreeMap;

/// Edge length of the squares whose fractions are compared, pixels. Smaller ones would compare single strands and the
/// noise of the path tracer.
const SQUARE: usize = 12;

/// Images with and without shadows.
pub type Pictures = [Linear; 2];

/// Our fractions and the reference's, over the hair pixels.
#[derive(Debug, Serialize)]
pub struct Transmission {
    /// Name of the image with shadows.
    pub name: String,
    /// Fraction of the light that arrives.
    #[serde(rename = "share")]
    pub fraction: f64,
    /// The reference's fraction.
    #[serde(rename = "reference_share")]
    pub reference_fraction: f64,
    /// Mean absolute difference of the fractions in squares of 12 pixels, weighted by their light.
    pub error: f64,
    /// Mean linear luminance without shadows, relative to the reference's.
    pub unshadowed: f64,
}

impl Transmission {
    /// Compares our images with `reference`.
    pub fn new(name: &str, rendered: &Pictures, reference: &Pictures, mask: &Image) -> Self {
        let of = |pictures: &Pictures| {
            let mut squares = BTreeMap::<_, [f64; 2]>::new();
            let wide = pictures[0].width as usize;
            for pixel in hair(mask) {
                let square = squares.entry((pixel % wide / SQUARE, pixel / wide / SQUARE)).or_default();
                for (sum, picture) in square.iter_mut().zip(pictures) {
                    *sum += picture.luminance(pixel);
                }
            }
            squares
        };
        let (rendered_squares, reference_squares) = (of(rendered), of(reference));
        let all = |squares: &BTreeMap<_, [f64; 2]>| {
            squares.values().fold([0.0; 2], |sum, square| [sum[0] + square[0], sum[1] + square[1]])
        };
        let fraction = |[lit, open]: [f64; 2]| lit / open.max(1e-12);
        let (rendered_sums, reference_sums) = (all(&rendered_squares), all(&reference_squares));
        let errors = rendered_squares.iter().map(|(square, a)| {
            let b = reference_squares[square];
            (fraction(*a) - fraction(b)).abs() * b[1]
        });
        Self {
            name: name.into(),
            fraction: fraction(rendered_sums),
            reference_fraction: fraction(reference_sums),
            error: errors.sum::<f64>() / reference_sums[1].max(1e-12),
            unshadowed: rendered_sums[1] / reference_sums[1].max(1e-12),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the left `left` / 2 of the light arrives, at the right `right` / 2.
    fn pictures(left: f32, right: f32) -> Pictures {
        let picture = |left: f32, right: f32| {
            let pixels = (0..48 * 24).map(|i| [if i % 48 < 24 { left } else { right }; 3]).collect();
            Linear { width: 48, pixels }
        };
        [picture(left, right), picture(2.0, 2.0)]
    }

    #[test]
    fn shares_are_compared_per_square() {
        let mask = Image { width: 48, height: 24, rgba: vec![255; 4 * 48 * 24] };
        let row = |ours: &Pictures| Transmission::new("a", ours, &pictures(1.0, 2.0), &mask);
        let same = row(&pictures(1.0, 2.0));
        assert!((same.fraction - 0.75).abs() < 1e-6 && same.error < 1e-9);
        // First the same light in the wrong place, then too little light.
        let moved = row(&pictures(2.0, 1.0));
        assert!((moved.fraction - 0.75).abs() < 1e-6 && (moved.error - 0.5).abs() < 1e-6, "{moved:?}");
        let dark = row(&pictures(0.8, 1.6));
        assert!((dark.fraction - 0.6).abs() < 1e-6 && (dark.error - 0.15).abs() < 1e-6, "{dark:?}");
    }
}
