//! Reproducible randomness: hashes, a small generator, and smooth noise.

use crate::hash::pcg;
use glam::Vec3;

/// A generator whose state is one number, so that every strand can have its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rng(u32);

impl Rng {
    /// Creates the stream `index` of `seed`.
    pub(crate) fn new(seed: u32, index: u32) -> Self {
        Self(pcg(seed ^ pcg(index)))
    }

    /// Returns the next 32 random bits.
    pub(crate) fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x6d2b_79f5);
        pcg(self.0)
    }

    /// Returns a uniform number in 0..1.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    /// Returns a uniform number in `lo..hi`.
    pub(crate) fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit()
    }

    /// Returns a bell-shaped number with mean 0 and standard deviation 1, never beyond 3: the sum of three uniforms.
    pub(crate) fn bell(&mut self) -> f32 {
        (self.unit() + self.unit() + self.unit() - 1.5) * 2.0
    }

    /// Returns a vector with independent [`bell`](Self::bell) coordinates.
    pub(crate) fn bell3(&mut self) -> Vec3 {
        Vec3::new(self.bell(), self.bell(), self.bell())
    }
}

/// Returns smooth value noise in -1..1 with features of unit size.
pub(crate) fn noise(p: Vec3, seed: u32) -> f32 {
    let base = p.floor();
    let f = p - base;
    let w = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let cell = base.as_ivec3();
    let corner = |x: i32, y: i32, z: i32| {
        let h = pcg((cell.x + x) as u32 ^ pcg((cell.y + y) as u32 ^ pcg((cell.z + z) as u32 ^ seed)));
        (h >> 8) as f32 / 8_388_608.0 - 1.0
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let plane =
        |z| mix(mix(corner(0, 0, z), corner(1, 0, z), w.x), mix(corner(0, 1, z), corner(1, 1, z), w.x), w.y);
    mix(plane(0), plane(1), w.z)
}

/// Returns the cubic step from 0 at `a` to 1 at `b`.
pub(crate) fn smoothstep(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Returns the linear blend of `a` and `b`.
pub(crate) fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_uniform_and_different() {
        let mut rng = Rng::new(7, 3);
        let mean = (0..4000).map(|_| rng.unit()).sum::<f32>() / 4000.0;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
        let mut spread = Rng::new(7, 4);
        let variance = (0..4000).map(|_| spread.bell().powi(2)).sum::<f32>() / 4000.0;
        assert!((variance - 1.0).abs() < 0.1, "{variance}");
        assert_ne!(Rng::new(7, 3).bits(), Rng::new(7, 4).bits());
        assert_ne!(Rng::new(7, 3).bits(), Rng::new(8, 3).bits());
    }

    #[test]
    fn noise_is_smooth_and_bounded() {
        let mut last = noise(Vec3::ZERO, 1);
        for i in 1..2000 {
            let now = noise(Vec3::new(0.01, 0.004, -0.007) * i as f32, 1);
            assert!(now.abs() <= 1.0 && (now - last).abs() < 0.08);
            last = now;
        }
    }
}
