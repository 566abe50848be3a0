//! Which samples around a pixel make it, where strands are masks of samples.
//!
//! A sample of a mask shows one strand whole, so a pixel is a mean over as many strands as it has samples, and when
//! strands move, each sample changes at once from one to the next. Four samples of the pixel's own square are too few
//! for that to be quiet. So all samples in a disc around the pixel's middle count, weighted by `1 - d²/r²`: of all
//! kernels that blur as much, the one with the least noise (Epanechnikov 1969). Of `n` samples per pixel three quarters
//! of the `n π r²` in the disc count as a whole one each; a radius of `2.5 / √n` pixels makes them about 15 for any `n`.
//! With 16 samples per pixel the disc is about as large as the pixel.
//!
//! Tried and left: wider strips with fewer samples each. They change less often, by the root of the width, but blur hair
//! across itself and leave each picture its noise (`docs/appearance/edges.md`).

use bytemuck::{Pod, Zeroable};
use glam::{IVec2, Vec2, Vec4};

use crate::constants::MAX_FOOTPRINT;

/// Twin of `present::resolve::Footprint`: samples that make a pixel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Footprint {
    /// Of each: the pixel it belongs to, counted from the one it counts for (x, y), its number there, and its weight.
    pub samples: [Vec4; MAX_FOOTPRINT as usize],
    /// How many there are.
    pub count: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// Radius of the disc, pixels, times the root of the number of samples.
const REACH: f32 = 2.5;

/// Where the samples of a pixel lie in it, sixteenths of a pixel: the standard pattern of D3D 11 and Vulkan, which WebGPU
/// asks for with four. Should an adapter place 8 or 16 elsewhere, its pixels are a little noisier, and nothing worse.
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
    /// What is quiet enough for masks of `samples` (4, 8 or 16) per pixel.
    pub fn disc(samples: u32) -> Self {
        let radius = REACH / (samples as f32).sqrt();
        let cells = (-2..=2).flat_map(|y| (-2..=2).map(move |x| IVec2::new(x, y)));
        let near = cells.flat_map(|cell| {
            pattern(samples).iter().enumerate().filter_map(move |(number, &[x, y])| {
                let from_middle = cell.as_vec2() + Vec2::new(f32::from(x), f32::from(y)) / 16.0 - 0.5;
                let weight = 1.0 - from_middle.length_squared() / (radius * radius);
                (weight > 0.0).then(|| cell.as_vec2().extend(number as f32).extend(weight))
            })
        });
        Self::of(near)
    }

    /// The pixel's own samples, each as much as the others.
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
    fn a_disc_counts_as_fifteen_samples_and_stays_in_its_place() {
        for n in [4, 8, 16] {
            let disc = Footprint::disc(n);
            let used = &disc.samples[..disc.count as usize];
            assert!(disc.count < MAX_FOOTPRINT, "{n}: none was left out");
            let sum: f32 = used.iter().map(|s| s.w).sum();
            assert!((sum - 1.0).abs() < 1e-5);
            // As many equal samples have as little noise.
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
