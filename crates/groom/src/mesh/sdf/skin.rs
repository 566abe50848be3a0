//! Selection of the triangles that are the boundary between solid and air.

use glam::Vec3;

use std::collections::HashMap;

use super::{TASK, TriMesh, Winding, signs};
use crate::mesh::parts;
use crate::{Progress, SdfGrid};

/// Distance in front of and behind a triangle at which the winding number is sampled, in cells: far enough for rounding
/// errors, near enough not to meet the next sheet.
const OFFSET: f32 = 0.02;

/// Behind a wide sheet in the air, the winding number comes up to 0.5. A solid side must exceed 0.5 by this much, which
/// is more than the error of the winding number.
const SHEET: f32 = 0.05;

/// Returns the triangles of `mesh` with air on one side and solid on the other, both resolved by the grid.
pub async fn boundary(
    mesh: &TriMesh,
    grid: &SdfGrid,
    field: &Winding<'_>,
    solid: &[bool],
    progress: &impl Progress,
) -> TriMesh {
    let coincident = coincident(mesh);
    let is_boundary = |(t, coincident): &(&[u32; 3], bool)| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if normal == Vec3::ZERO {
            return false;
        }
        let center = (a + b + c) / 3.0;
        let parts = |p: Vec3| {
            if signs::around(grid, solid, p) != (true, true) {
                return false;
            }
            let front_point = p + normal * (OFFSET * grid.cell);
            let mut front = field.at(front_point);
            // The winding number jumps by one across a single triangle.
            let mut back = front + field.sign;
            if *coincident || (back - 0.5).abs() < 3.0 * SHEET {
                front = field.precise(front_point);
                back = field.precise(p - normal * (OFFSET * grid.cell));
            }
            front.min(back) <= 0.5 && front.max(back) > 0.5 + SHEET
        };
        // A triangle of many cells can dive into another part; keep it if it surfaces anywhere.
        let large = [a, b, c].iter().any(|p| p.distance(center) > 2.0 * grid.cell);
        parts(center) || (large && [a, b, c].iter().any(|p| parts(center.lerp(*p, 0.75))))
    };
    let mut triangles = Vec::new();
    for (i, triangle) in mesh.triangles.iter().zip(coincident).enumerate() {
        if i % 1024 == 0 {
            progress.step(TASK, 0.4 + 0.2 * i as f32 / mesh.triangles.len() as f32).await;
        }
        if is_boundary(&triangle) {
            triangles.push(*triangle.0);
        }
    }
    TriMesh { positions: mesh.positions.clone(), triangles, ..Default::default() }
}

/// Returns for every triangle whether another one has the same corners, in any order: a sheet modeled from both sides.
fn coincident(mesh: &TriMesh) -> Vec<bool> {
    let weld = parts::weld_map(&mesh.positions);
    let key = |t: &[u32; 3]| {
        let mut key = t.map(|v| weld[v as usize]);
        key.sort_unstable();
        key
    };
    let mut counts: HashMap<[u32; 3], u32> = HashMap::new();
    mesh.triangles.iter().for_each(|t| *counts.entry(key(t)).or_default() += 1);
    mesh.triangles.iter().map(|t| counts[&key(t)] > 1).collect()
}
