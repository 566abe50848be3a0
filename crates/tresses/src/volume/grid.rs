//! Position of the grid, and mean density of a groom.

use crate::strands::RestGuides;
use glam::{IVec3, Vec3};

/// Size of the grid relative to the rest hair; the margin is for swinging hair.
const GRID_SCALE: f32 = 1.3;
/// Edge of the cells in which the mean density of a groom is measured, meters.
const MEASURE: f32 = 0.03;

/// A cube of cells in groom space, the head's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VolumeGrid {
    /// Lowest corner, meters.
    pub origin: Vec3,
    /// Edge of a cell, meters.
    pub cell: f32,
    /// Cells along each axis.
    pub resolution: u32,
    /// Texture coordinate of the head's origin.
    pub bias: Vec3,
    /// Texture coordinates per meter.
    pub scale: f32,
}

impl VolumeGrid {
    /// Returns the grid around hair that rests at `positions` (groom space, meters).
    pub fn around(positions: impl Iterator<Item = Vec3>, resolution: u32) -> Self {
        let (lo, hi) = positions
            .map(|p| (p, p))
            .reduce(|(lo, hi), (p, q)| (lo.min(p), hi.max(q)))
            .unwrap_or((Vec3::splat(-0.1), Vec3::splat(0.1)));
        let edge = ((hi - lo).max_element() * GRID_SCALE).max(0.05);
        let origin = 0.5 * (lo + hi) - 0.5 * edge;
        Self { origin, cell: edge / resolution as f32, resolution, bias: -origin / edge, scale: 1.0 / edge }
    }
}

/// Returns the mean density at rest, weighted by hair, km/m³; independent of the grid.
pub(super) fn mean_density(rest: &RestGuides) -> f32 {
    let n = rest.vertex_count.max(2) as usize;
    let mut masses: Vec<(IVec3, f64)> = rest
        .rest
        .iter()
        .enumerate()
        .map(|(i, vertex)| {
            let (vertex_index, info) = (i / rest.info.len(), &rest.info[i % rest.info.len()]);
            let end = if vertex_index == 0 || vertex_index + 1 == n { 0.5 } else { 1.0 };
            let meters = info.strands * info.length / (n - 1) as f32 * end;
            let meters = if meters.is_finite() { meters.max(0.0) } else { 0.0 };
            ((vertex.position / MEASURE).floor().as_ivec3(), f64::from(meters))
        })
        .collect();
    masses.sort_by_key(|(cell, _)| cell.to_array());
    let (mut square, mut sum) = (0.0, 0.0);
    for same in masses.chunk_by(|a, b| a.0 == b.0) {
        let mass: f64 = same.iter().map(|(_, mass)| mass).sum();
        square += mass * mass;
        sum += mass;
    }
    let volume = f64::from(MEASURE).powi(3);
    if sum > 0.0 { (square / sum / volume / 1e3) as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strands::{Guide, GuideRest};

    #[test]
    fn grid_encloses_hair_with_margin() {
        let points = [Vec3::new(-0.1, 1.2, 0.0), Vec3::new(0.1, 1.7, 0.05)];
        let grid = VolumeGrid::around(points.into_iter(), 32);
        assert!((grid.cell * 32.0 - 0.65).abs() < 1e-6);
        for p in points {
            let c = p * grid.scale + grid.bias;
            assert!(c.min_element() > 0.1 && c.max_element() < 0.9, "{c}");
        }
        assert!((Vec3::new(0.0, 1.45, 0.025) * grid.scale + grid.bias - 0.5).abs().max_element() < 1e-5);
    }

    #[test]
    fn mean_density_of_uniform_hair_is_exact() {
        // 1,000 guides of 3 cm in a cube of 30 cm, 10 strands each: 300 m in 0.027 m³.
        let (count, n) = (1000, 4);
        let info = vec![Guide { length: 0.03, stiffness: 1.0, strands: 10.0, ..Guide::default() }; count];
        let rest = (0..n * count)
            .map(|i| {
                let (v, g) = (i / count, i % count);
                let corner = Vec3::new((g % 10) as f32, (g / 10 % 10) as f32, (g / 100) as f32) * 0.03;
                let y = 0.0001 + 0.0298 * v as f32 / 3.0;
                GuideRest { position: corner + Vec3::new(0.01, y, 0.01), contact: 0.0 }
            })
            .collect();
        let groom = RestGuides { vertex_count: n as u32, info, rest, shape: Vec::new() };
        let found = mean_density(&groom);
        assert!((found - 11.11).abs() < 0.3, "{found}");
    }
}
