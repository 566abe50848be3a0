//! Texels of a distance field.

use crate::groom::SdfGrid;
use glam::{UVec3, Vec3, Vec4};
use half::f16;

/// A distance field as texels: the unit gradient (xyz) and the distance (w, meters).
#[derive(Clone, Debug)]
pub struct FieldVolume {
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

    /// Returns the value of a trilinear, clamping sampler at texture coordinate `c`.
    pub fn sample(&self, c: Vec3) -> Vec4 {
        let last = (self.size - UVec3::ONE).as_vec3();
        let p = (c * self.size.as_vec3() - 0.5).clamp(Vec3::ZERO, last);
        let base = p.floor();
        let f = p - base;
        let base = base.as_uvec3();
        let at = |x: u32, y: u32, z: u32| {
            let i = (base + UVec3::new(x, y, z)).min(self.size - UVec3::ONE);
            let t = self.texels[(i.x + self.size.x * (i.y + self.size.y * i.z)) as usize];
            Vec4::from_array(t.map(f16::to_f32))
        };
        let row = |y, z| at(0, y, z).lerp(at(1, y, z), f.x);
        row(0, 0).lerp(row(1, 0), f.y).lerp(row(0, 1).lerp(row(1, 1), f.y), f.z)
    }
}

/// Box around the solid part of a field, and the sphere with the same center, meters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolidBounds {
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
    fn volume_samples_match_grid() {
        let grid = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::new(0.2, 0.25, 0.2), 41, |p| p.length() - 0.1);
        let volume = FieldVolume::new(&grid);
        for p in [Vec3::new(0.1, 0.02, 0.03), Vec3::new(-0.05, 0.11, 0.0), Vec3::new(0.0, -0.1, 0.1)] {
            let sample = volume.sample(p * volume.scale + volume.bias);
            assert!((sample.w - grid.sample(p)).abs() < 1e-4, "{p}");
            assert!(sample.truncate().normalize().dot(p.normalize()) > 0.999, "{p}");
        }
    }
}
