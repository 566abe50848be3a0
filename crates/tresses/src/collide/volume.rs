//! Texels of a distance field.

use crate::groom::SdfGrid;
use glam::{UVec3, Vec3};
use half::f16;

/// A distance field as texels: the unit gradient (xyz) and the distance (w, meters).
#[derive(Clone, Debug)]
pub(crate) struct FieldVolume {
    /// Nodes along each axis.
    pub size: UVec3,
    /// Texture coordinate of the origin of the field's frame.
    pub bias: Vec3,
    /// Texture coordinates per meter.
    pub scale: Vec3,
    /// Bounds of the solid part, in the field's frame.
    pub bounds: SolidBounds,
    pub(crate) texels: Vec<[f16; 4]>,
}

impl FieldVolume {
    /// Samples distances and gradients at the nodes of `grid`.
    pub fn new(grid: &SdfGrid) -> Self {
        let nodes = grid.node_normals().zip(&grid.distances);
        let texels = nodes.map(|(n, d)| [n.x, n.y, n.z, *d].map(f16::from_f32)).collect();
        let (bias, scale) = Self::coordinates(grid);
        Self { size: grid.size, bounds: SolidBounds::of(grid), bias, scale, texels }
    }

    /// Returns bias and scale of the texture coordinates of `grid`'s texels.
    pub(super) fn coordinates(grid: &SdfGrid) -> (Vec3, Vec3) {
        let size = grid.size.as_vec3();
        ((Vec3::splat(0.5) - grid.origin / grid.cell) / size, 1.0 / (grid.cell * size))
    }
}

/// Box around the solid part of a field, and the sphere with the same center, meters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SolidBounds {
    /// Center of box and sphere.
    pub center: Vec3,
    /// Half the lengths of the box's edges.
    pub half: Vec3,
    /// Radius of the sphere.
    pub radius: f32,
}

impl SolidBounds {
    /// Returns the bounds of the points, with a `margin` on all sides; `None` without points.
    pub(super) fn around(points: impl Iterator<Item = Vec3> + Clone, margin: f32) -> Option<Self> {
        let first = points.clone().next()?;
        let (lo, hi) = points.clone().fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let center = 0.5 * (lo + hi);
        let radius = points.map(|p| p.distance(center)).fold(0.0, f32::max) + margin;
        Some(Self { center, half: 0.5 * (hi - lo) + margin, radius })
    }

    /// Returns bounds of all nodes that are solid or next to a solid one, extended by a cell. Between nodes outside the
    /// box, the field is nowhere below one cell.
    fn of(grid: &SdfGrid) -> Self {
        let nodes = grid.distances.iter().enumerate().filter(|(_, d)| **d < grid.cell);
        let solid = nodes.map(|(i, _)| grid.node(i as u32));
        Self::around(solid, grid.cell).unwrap_or(Self { center: grid.origin, ..Self::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_match_grid() {
        let grid = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::new(0.2, 0.25, 0.2), 41, |p| p.length() - 0.1);
        let volume = FieldVolume::new(&grid);
        for i in (0..volume.texels.len()).step_by(997) {
            let (p, [x, y, z, distance]) = (grid.node(i as u32), volume.texels[i].map(f16::to_f32));
            let texel = (p * volume.scale + volume.bias) * volume.size.as_vec3() - 0.5;
            assert_eq!(
                texel.round().as_uvec3().dot(UVec3::new(1, grid.size.x, grid.size.x * grid.size.y)),
                i as u32
            );
            // The rounding of a 16-bit float.
            let expected = p.length() - 0.1;
            assert!((distance - expected).abs() <= expected.abs() / 2048.0 + 1e-6, "{p}");
            let off = Vec3::new(x, y, z).normalize().dot(p.normalize());
            assert!(off > 0.99 || p.length() < 0.03, "{p}: {off}");
        }
    }
}
