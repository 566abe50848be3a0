//! Which triangles are the boundary between solid and air.

use glam::Vec3;

use super::{TriMesh, Winding, signs};
use crate::groom::SdfGrid;

/// How far in front of and behind a triangle it is asked what is there, in cells: far enough for
/// rounding errors, near enough not to meet the next sheet.
const OFFSET: f32 = 0.02;

/// The triangles of `mesh` with air on one side and solid on the other, both of which the grid shows.
pub fn boundary(mesh: &TriMesh, grid: &SdfGrid, field: &Winding<'_>, solid: &[bool]) -> TriMesh {
    let is_boundary = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if normal == Vec3::ZERO {
            return false;
        }
        let center = (a + b + c) / 3.0;
        let parts = |p: Vec3| {
            signs::around(grid, solid, p) == (true, true)
                && (field.at(p + normal * (OFFSET * grid.cell)) > 0.5)
                    != (field.at(p - normal * (OFFSET * grid.cell)) > 0.5)
        };
        // A triangle of many cells can dive into another part; it stays if it surfaces anywhere.
        let large = [a, b, c].iter().any(|p| p.distance(center) > 2.0 * grid.cell);
        parts(center) || (large && [a, b, c].iter().any(|p| parts(center.lerp(*p, 0.75))))
    };
    let triangles = mesh.triangles.iter().filter(is_boundary).copied().collect();
    TriMesh { positions: mesh.positions.clone(), triangles, ..Default::default() }
}
