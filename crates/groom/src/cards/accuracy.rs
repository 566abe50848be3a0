//! How well cards cover what strands cover.

use super::picture::Opacity;

/// Sizes of hair for which the difference is measured, pixels.
pub const SIZES: [u32; 7] = [256, 128, 64, 32, 16, 8, 4];

/// Largest mean difference of opacity at which a level may replace strands.
const VISIBLE: f32 = 0.07;

/// Opacity of cards against the opacity of strands, in 14 pictures from all sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardAccuracy {
    /// Sum of the smaller opacity of each pixel over the sum of the larger one; 1 for equal pictures.
    pub soft_iou: f32,
    /// The same for pixels of at least half opacity.
    pub silhouette_iou: f32,
    /// Area of the cards over the area of the strands.
    pub coverage: f32,
    /// The same for the pictures with the least and the most.
    pub coverage_range: [f32; 2],
    /// Mean difference of the opacity over the pixels with hair, for each of [`SIZES`].
    pub difference: [f32; SIZES.len()],
    /// Size of the hair in pixels up to which the level may replace the strands: the mean difference is at most 0.07.
    /// 0 if it is larger at all sizes.
    pub switch: f32,
}

fn total(image: &Opacity) -> f32 {
    image.iter().sum()
}

/// Halves the edge of an image of `size` pixels.
fn halved(image: &Opacity, size: usize) -> Opacity {
    let half = size / 2;
    let mean = |i: usize| {
        let at = i / half * 2 * size + i % half * 2;
        0.25 * (image[at] + image[at + 1] + image[at + size] + image[at + size + 1])
    };
    (0..half * half).map(mean).collect()
}

/// Returns pictures of [`SIZES`]`[0]` pixels at the smaller `size`.
pub(super) fn shrunk(pictures: &[Opacity], size: usize) -> Vec<Opacity> {
    let shrink = |picture: &Opacity| {
        let (mut picture, mut now) = (picture.clone(), SIZES[0] as usize);
        while now > size {
            picture = halved(&picture, now);
            now /= 2;
        }
        picture
    };
    pictures.iter().map(shrink).collect()
}

/// Returns the sum of the smaller opacity of each pixel over the sum of the larger one.
pub(super) fn soft_iou(a: &[Opacity], b: &[Opacity]) -> f32 {
    let pairs = a.iter().zip(b).flat_map(|(a, b)| a.iter().zip(b));
    let (both, either) =
        pairs.fold((0.0, 0.0), |(both, either), (a, b)| (both + a.min(*b), either + a.max(*b)));
    if either > 0.0 { both / either } else { 1.0 }
}

impl CardAccuracy {
    /// Compares pictures of 256 pixels.
    pub(super) fn new(strands: &[Opacity], cards: &[Opacity]) -> Self {
        let pairs = || strands.iter().zip(cards).flat_map(|(a, b)| a.iter().zip(b));
        let ratio = |above: f32, below: f32| if below > 0.0 { above / below } else { 1.0 };
        let solid = |both: bool| {
            pairs().filter(|(a, b)| if both { a.min(**b) >= 0.5 } else { a.max(**b) >= 0.5 }).count() as f32
        };
        let views: Vec<f32> = strands.iter().zip(cards).map(|(a, b)| ratio(total(b), total(a))).collect();
        let mut difference = [0.0; SIZES.len()];
        let (mut a, mut b) = (strands.to_vec(), cards.to_vec());
        let mut size = SIZES[0] as usize;
        for found in &mut difference {
            let (mut sum, mut count) = (0.0, 0.0);
            for (a, b) in a.iter().zip(&b).flat_map(|(a, b)| a.iter().zip(b)) {
                if a.max(*b) > 0.004 {
                    sum += (a - b).abs();
                    count += 1.0;
                }
            }
            *found = ratio(sum, count);
            if size > SIZES[SIZES.len() - 1] as usize {
                a.iter_mut().for_each(|image| *image = halved(image, size));
                b.iter_mut().for_each(|image| *image = halved(image, size));
                size /= 2;
            }
        }
        Self {
            soft_iou: soft_iou(strands, cards),
            silhouette_iou: ratio(solid(true), solid(false)),
            coverage: ratio(cards.iter().map(total).sum(), strands.iter().map(total).sum()),
            coverage_range: views.iter().fold([f32::INFINITY, 0.0], |[lo, hi], v| [lo.min(*v), v.max(hi)]),
            switch: switch(&difference),
            difference,
        }
    }

    /// Interpolates the mean difference of the opacity at a size of the hair in pixels.
    #[must_use]
    pub fn difference_at(&self, size: f32) -> f32 {
        let last = SIZES.len() - 1;
        let at = (SIZES[0] as f32 / size.max(1.0)).log2().clamp(0.0, last as f32);
        let low = (at as usize).min(last - 1);
        let [a, b] = [self.difference[low], self.difference[low + 1]];
        a + (b - a) * (at - low as f32)
    }
}

/// Interpolates the size at which the difference is [`VISIBLE`].
fn switch(difference: &[f32]) -> f32 {
    let size = |i: usize| SIZES[i] as f32;
    let Some(first) = difference.iter().position(|d| *d <= VISIBLE) else { return 0.0 };
    if first == 0 {
        return size(0);
    }
    let (above, below) = (difference[first - 1], difference[first]);
    let t = (VISIBLE - below) / (above - below).max(1e-6);
    size(first) * (size(first - 1) / size(first)).powf(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_agree_and_shifted_ones_do_not() {
        let disc = |shift: f32| -> Opacity {
            (0..256 * 256)
                .map(|i| {
                    let (x, y) = ((i % 256) as f32 - 128.0 - shift, (i / 256) as f32 - 128.0);
                    f32::from(u8::from(x.hypot(y) < 100.0))
                })
                .collect()
        };
        let same = CardAccuracy::new(&[disc(0.0)], &[disc(0.0)]);
        assert_eq!((same.soft_iou, same.silhouette_iou, same.coverage, same.switch), (1.0, 1.0, 1.0, 256.0));
        let shifted = CardAccuracy::new(&[disc(0.0)], &[disc(20.0)]);
        assert!(shifted.soft_iou < 0.8 && (shifted.coverage - 1.0).abs() < 1e-3);
        assert!(shifted.difference[0] > shifted.difference[4] && shifted.switch < 256.0, "{shifted:?}");
        assert!((shifted.difference_at(128.0) - shifted.difference[1]).abs() < 1e-6);
        assert_eq!(shifted.switch, 0.0);
        let shifted = CardAccuracy::new(&[disc(0.0)], &[disc(7.0)]);
        assert!((shifted.difference_at(shifted.switch) - VISIBLE).abs() < 0.005, "{shifted:?}");
        let thin = CardAccuracy::new(&[disc(0.0)], &[disc(0.0).iter().map(|a| 0.5 * a).collect()]);
        assert_eq!((thin.soft_iou, thin.coverage), (0.5, 0.5));
    }
}
