//! Painted levels of detail.

use crate::{
    Error, Result,
    groom::{
        BoundStrands,
        character::LodLevel,
        scalp::{ScalpMap, scalp_uv},
    },
};
use glam::Vec3;

/// Maximum number of painted levels.
pub const MAX_LEVELS: usize = 4;

/// Maximum factor on strand width in a map, about 4: a factor is stored in a byte, of which 63 is 1.
pub const MAX_THICKNESS: f32 = 255.0 / 63.0;

/// Baked factors of all strands.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PaintedFactors {
    /// Sizes of the levels, descending.
    pub sizes: Vec<f32>,
    /// One byte per level for each strand: 255 is 1.
    pub density: Vec<u32>,
    /// One byte per level for each strand: 63 is 1.
    pub thickness: Vec<u32>,
    /// Maximum density of each level.
    pub max_density: [f32; MAX_LEVELS],
}

impl PaintedFactors {
    /// Returns factors of 1 for `count` strands.
    pub fn none(count: usize) -> Self {
        Self {
            sizes: Vec::new(),
            density: vec![u32::MAX; count],
            thickness: vec![0x3f3f_3f3f; count],
            max_density: [1.0; MAX_LEVELS],
        }
    }

    /// Samples the maps of `levels` at the roots of `strands`. `skull` is the center of the braincase.
    pub fn bake(strands: &BoundStrands, levels: &[LodLevel], skull: Vec3) -> Result<Self> {
        let sizes: Vec<f32> = levels.iter().map(|level| level.size).collect();
        let falls = sizes.windows(2).all(|w| w[0] > w[1]);
        let positive = sizes.iter().all(|size| size.is_finite() && *size > 0.0);
        if levels.len() > MAX_LEVELS || !falls || !positive {
            return Err(Error::Parameter {
                name: "painted levels of detail",
                value: format!("sizes {sizes:?}"),
                range: "at most four, with positive sizes in descending order",
            });
        }
        let mut painted = Self { sizes, ..Self::none(strands.len()) };
        if levels.is_empty() {
            return Ok(painted);
        }
        let mut max_density = [0u32; MAX_LEVELS];
        for i in 0..strands.len() {
            let uv = strands.rest_positions(i).next().map(|root| scalp_uv(root - skull)).unwrap_or_default();
            let byte = |map: &Option<ScalpMap>, full: f32| {
                let value = map.as_ref().map_or(1.0, |map| map.sample(uv));
                ((value / full).clamp(0.0, 1.0) * 255.0 + 0.5) as u32
            };
            let (mut density, mut thickness) = (0, 0);
            for (k, level) in levels.iter().enumerate() {
                let d = byte(&level.density, 1.0);
                max_density[k] = max_density[k].max(d);
                density |= d << (8 * k);
                thickness |= byte(&level.thickness, MAX_THICKNESS) << (8 * k);
            }
            (painted.density[i], painted.thickness[i]) = (density, thickness);
        }
        painted.max_density = max_density.map(|d| d as f32 / 255.0);
        Ok(painted)
    }

    /// Returns the blend weights of the levels for hair of `size` pixels.
    pub fn weights(&self, size: f32) -> [f32; MAX_LEVELS] {
        let mut weights = [0.0; MAX_LEVELS];
        let Some(last) = self.sizes.len().checked_sub(1) else {
            weights[0] = 1.0;
            return weights;
        };
        // The first level whose size is at most the hair's.
        match self.sizes.iter().position(|s| *s <= size) {
            None => weights[last] = 1.0,
            Some(0) => weights[0] = 1.0,
            Some(k) => {
                let (large, small) = (self.sizes[k - 1], self.sizes[k]);
                let t = (large / size).ln() / (large / small).ln();
                (weights[k - 1], weights[k]) = (1.0 - t, t);
            }
        }
        weights
    }

    /// Returns an upper bound of the density at `weights`.
    pub fn most(&self, weights: &[f32; MAX_LEVELS]) -> f32 {
        weights.iter().zip(&self.max_density).map(|(w, d)| w * d).sum::<f32>().min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{groom::Influence, strands::Strand};

    fn roots() -> BoundStrands {
        let mut strands = BoundStrands::new(2);
        for x in [-0.08f32, 0.08] {
            let root = Vec3::new(x, 0.05, 0.0);
            let influence = Influence { guide: 0, weight: 1.0, scale: 1.0 };
            strands.push(Strand::default(), &[root, root + Vec3::Y], &[1.0; 2], &[influence]);
        }
        strands
    }

    #[test]
    fn maps_are_sampled_at_strand_roots() {
        let side = |left: f32, right: f32| {
            Some(ScalpMap::from_fn(32, move |uv| if uv.x > 0.5 { left } else { right }))
        };
        let levels = [
            LodLevel { size: 400.0, ..Default::default() },
            LodLevel { size: 100.0, density: side(0.5, 0.25), thickness: side(2.0, 1.0) },
        ];
        let painted = PaintedFactors::bake(&roots(), &levels, Vec3::ZERO).unwrap();
        assert_eq!(painted.density.iter().map(|d| d & 0xffff).collect::<Vec<_>>(), [0x40ff, 0x80ff]);
        assert_eq!(painted.thickness.iter().map(|t| t & 0xffff).collect::<Vec<_>>(), [0x3f3f, 0x7e3f]);
        assert_eq!(painted.weights(1000.0)[0], 1.0);
        assert_eq!(painted.weights(10.0)[1], 1.0);
        let half = painted.weights(200.0);
        assert!((half[0] - 0.5).abs() < 1e-5 && (half[1] - 0.5).abs() < 1e-5);
        assert!((painted.most(&half) - 0.751).abs() < 2e-3, "{}", painted.most(&half));
        let wrong = [levels[1].clone(), levels[0].clone()];
        assert!(PaintedFactors::bake(&roots(), &wrong, Vec3::ZERO).is_err());
        assert!(PaintedFactors::bake(&roots(), &vec![levels[0].clone(); 5], Vec3::ZERO).is_err());
    }
}
