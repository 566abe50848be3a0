//! Fraction of the light that reaches visible hair: single-scattered light with shadows, divided by the same without
//! shadows.

use super::metrics::{Linear, hair};
use crate::picture::Picture;
use serde::Serialize;
use std::collections::BTreeMap;

/// Edge length of the squares whose fractions are compared, pixels. Smaller ones would compare single strands and the
/// noise of the path tracer.
const SQUARE: usize = 12;

/// Images with and without shadows.
pub type Pictures = [Linear; 2];

/// Our fractions and the reference's, over the hair pixels.
#[derive(Debug, Serialize)]
pub struct Share {
    /// Name of the image with shadows.
    pub name: String,
    /// Fraction of the light that arrives.
    pub share: f64,
    /// The reference's fraction.
    pub reference_share: f64,
    /// Mean absolute difference of the fractions in squares of 12 pixels, weighted by their light.
    pub error: f64,
    /// Mean linear luminance without shadows, relative to the reference's.
    pub unshadowed: f64,
}

impl Share {
    /// Compares our images with `reference`.
    pub fn new(name: &str, ours: &Pictures, reference: &Pictures, mask: &Picture) -> Self {
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
        let (ours, theirs) = (of(ours), of(reference));
        let all = |squares: &BTreeMap<_, [f64; 2]>| {
            squares.values().fold([0.0; 2], |sum, square| [sum[0] + square[0], sum[1] + square[1]])
        };
        let share = |[lit, open]: [f64; 2]| lit / open.max(1e-12);
        let (mine, other) = (all(&ours), all(&theirs));
        let errors = ours.iter().map(|(square, a)| {
            let b = theirs[square];
            (share(*a) - share(b)).abs() * b[1]
        });
        Self {
            name: name.into(),
            share: share(mine),
            reference_share: share(other),
            error: errors.sum::<f64>() / other[1].max(1e-12),
            unshadowed: mine[1] / other[1].max(1e-12),
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
        let mask = Picture { width: 48, height: 24, rgba: vec![255; 4 * 48 * 24] };
        let row = |ours: &Pictures| Share::new("a", ours, &pictures(1.0, 2.0), &mask);
        let same = row(&pictures(1.0, 2.0));
        assert!((same.share - 0.75).abs() < 1e-6 && same.error < 1e-9);
        // First the same light in the wrong place, then too little light.
        let moved = row(&pictures(2.0, 1.0));
        assert!((moved.share - 0.75).abs() < 1e-6 && (moved.error - 0.5).abs() < 1e-6, "{moved:?}");
        let dark = row(&pictures(0.8, 1.6));
        assert!((dark.share - 0.6).abs() < 1e-6 && (dark.error - 0.15).abs() < 1e-6, "{dark:?}");
    }
}
