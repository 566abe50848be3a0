//! The footprint of a pixel: samples that are averaged, for strands drawn as sample masks.
//!
//! A sample of a mask shows one strand at full opacity. A pixel with few samples therefore averages few strands, and
//! each sample switches at once from one strand to the next when they move: with four samples the pixel would flicker.
//! So all samples in a disc around the pixel's center count, weighted by `1 - d²/r²`, the kernel with the least noise
//! for a given blur (Epanechnikov 1969). With `n` samples per pixel, the disc is equivalent to three quarters of its
//! `n π r²` samples at equal weight. A radius of `2.5 / √n` pixels makes that about 15 for any `n`; with 16 samples per
//! pixel the disc is about as large as the pixel.
//!
//! Rejected: wider strips with fewer samples each. They change less often, by the square root of the width, but blur
//! hair across its width and leave the noise in each frame (`docs/validation/coverage.md`).

use bytemuck::{Pod, Zeroable};
use glam::{IVec2, Vec2, Vec4};

use crate::constants::MAX_FOOTPRINT;

/// Samples that make up a pixel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Footprint {
    /// For each sample: the offset of its pixel (x, y), its number in that pixel, and its weight.
    pub samples: [Vec4; MAX_FOOTPRINT as usize],
    /// Number of samples.
    pub count: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// Radius of the disc, pixels, times the square root of the number of samples.
const RADIUS: f32 = 2.5;

/// Positions of a pixel's samples, sixteenths of a pixel: the standard pattern of D3D 11 and Vulkan, which WebGPU
/// requires for four samples. If an adapter places 8 or 16 samples elsewhere, pixels are only a little noisier.
fn pattern(samples: u32) -> &'static [[u8; 2]] {
    match samples {
        4 => &[[6, 2], [14, 6], [2, 10], [10, 14]],
        8 => &[[9, 5], [7, 11], [13, 9], [5, 3], [3, 13], [1, 7], [11, 15], [15, 1]],
        16 => &[
            [9, 9],
            [7, 5],
            [5, 10],
            [12, 7],
            [3, 6],
            [10, 13],
            [13, 11],
            [11, 3],
            [6, 14],
            [8, 1],
            [4, 2],
            [2, 12],
            [0, 8],
            [15, 4],
            [14, 15],
            [1, 0],
        ],
        _ => &[[8, 8]],
    }
}

impl Footprint {
    /// Disc of samples for masks of `samples` (4, 8 or 16) per pixel.
    pub fn disc(samples: u32) -> Self {
        let radius = RADIUS / (samples as f32).sqrt();
        let cells = (-2..=2).flat_map(|y| (-2..=2).map(move |x| IVec2::new(x, y)));
        let near = cells.flat_map(|cell| {
            pattern(samples).iter().enumerate().filter_map(move |(number, &[x, y])| {
                let offset = cell.as_vec2() + Vec2::new(f32::from(x), f32::from(y)) / 16.0 - 0.5;
                let weight = 1.0 - offset.length_squared() / (radius * radius);
                (weight > 0.0).then(|| cell.as_vec2().extend(number as f32).extend(weight))
            })
        });
        Self::of(near)
    }

    /// The pixel's own samples with equal weights.
    pub fn square(samples: u32) -> Self {
        Self::of((0..samples).map(|number| Vec4::new(0.0, 0.0, number as f32, 1.0)))
    }

    fn of(samples: impl Iterator<Item = Vec4>) -> Self {
        let mut footprint = Self::zeroed();
        let mut total = 0.0;
        for (to, sample) in footprint.samples.iter_mut().zip(samples) {
            *to = sample;
            total += sample.w;
            footprint.count += 1;
        }
        for sample in &mut footprint.samples {
            sample.w /= total;
        }
        footprint
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disc_is_centered_and_equals_fifteen_samples() {
        for n in [4, 8, 16] {
            let disc = Footprint::disc(n);
            let used = &disc.samples[..disc.count as usize];
            assert!(disc.count < MAX_FOOTPRINT, "{n}: none was left out");
            let sum: f32 = used.iter().map(|s| s.w).sum();
            assert!((sum - 1.0).abs() < 1e-5);
            // Number of equally weighted samples with the same noise.
            let whole = 1.0 / used.iter().map(|s| s.w * s.w).sum::<f32>();
            assert!((13.5..16.0).contains(&whole), "{n}: {whole}");
            let place = |s: &Vec4| {
                let [x, y] = pattern(n)[s.z as usize];
                s.truncate().truncate() + Vec2::new(f32::from(x), f32::from(y)) / 16.0 - 0.5
            };
            let middle: Vec2 = used.iter().map(|s| s.w * place(s)).sum();
            assert!(middle.length() < 0.05, "{n}: {middle}");
        }
        let square = Footprint::square(4);
        assert_eq!((square.count, square.samples[3]), (4, Vec4::new(0.0, 0.0, 3.0, 0.25)));
    }
}
