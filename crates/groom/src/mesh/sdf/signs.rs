//! Classification of the nodes of a grid as solid or air.
//!
//! Away from the triangles the winding number is harmonic, so one value bounds its neighborhood. If `u >= 0` is
//! harmonic in a ball of radius `d`, Harnack's inequality bounds it by `u(0) (1 + t) / (1 - t)^2` in the ball of radius
//! `t d`. As long as that is less than 0.5, the whole smaller ball is on the same side. A few evaluations thus classify
//! most of the air and of the solid, also across openings, where connectivity fails.

use glam::{IVec3, Vec3};

use super::{ROUGH_ERROR, TASK, Winding};
use crate::{Progress, SdfGrid};

/// Minimum number of nodes of a solid piece; smaller ones are noise.
const SPECK: usize = 8;

/// Returns for every node whether it is solid.
pub async fn solid(
    grid: &SdfGrid,
    field: &Winding<'_>,
    fill_cavities: bool,
    progress: &impl Progress,
) -> Vec<bool> {
    let mut solid = by_winding(grid, field, progress).await;
    let islands = islands(grid, &solid);
    let largest = islands.iter().filter(|i| i.solid).map(|i| i.nodes.len()).max().unwrap_or(0);
    for island in islands {
        let size = island.nodes.len();
        if (island.solid && size < SPECK.min(largest)) || (!island.solid && !island.border && fill_cavities) {
            island.nodes.iter().for_each(|&i| solid[i as usize] = !island.solid);
        }
    }
    solid
}

async fn by_winding(grid: &SdfGrid, field: &Winding<'_>, progress: &impl Progress) -> Vec<bool> {
    let size = grid.size.as_ivec3();
    let mut known: Vec<Option<bool>> = vec![None; size.element_product() as usize];
    let index = |c: IVec3| (c.x + size.x * (c.y + size.y * c.z)) as usize;
    let mut hint = None;
    let mut queries = 0u32;
    for stride in [16, 8, 4, 2, 1] {
        let steps = |n: i32| (0..n).step_by(stride);
        for c in steps(size.z)
            .flat_map(|z| steps(size.y).flat_map(move |y| steps(size.x).map(move |x| IVec3::new(x, y, z))))
        {
            if known[index(c)].is_some() {
                continue;
            }
            queries += 1;
            if queries.is_multiple_of(256) {
                // Most of the work is at the last and finest stride.
                let done = if stride > 1 { 0.0 } else { c.z as f32 / size.z as f32 };
                progress.step(TASK, 0.1 + 0.3 * done).await;
            }
            let p = grid.origin + c.as_vec3() * grid.cell;
            let w = field.at(p);
            let is_solid = w > 0.5;
            known[index(c)] = Some(is_solid);
            let t = safe_fraction(if is_solid { 1.0 - w } else { w });
            // Balls of less than a cell classify no other node.
            let Some((slot, nearest)) =
                (t > 0.0).then(|| field.bvh.nearest(p, f32::INFINITY, hint, 0.05)).flatten()
            else {
                continue;
            };
            hint = Some(slot);
            let radius = t * nearest.distance / grid.cell;
            if radius >= 1.0 {
                stamp(&mut known, size, c, radius, is_solid);
            }
        }
    }
    known.into_iter().map(|s| s == Some(true)).collect()
}

/// Returns the fraction of the distance to the nearest triangle within which the side cannot change, for a winding
/// number that is `u` away from its ideal.
fn safe_fraction(u: f32) -> f32 {
    let k = 0.5 / (u.max(0.0) + ROUGH_ERROR);
    if k <= 1.0 { 0.0 } else { (2.0 * k + 1.0 - (8.0 * k + 1.0).sqrt()) / (2.0 * k) }
}

fn stamp(known: &mut [Option<bool>], size: IVec3, center: IVec3, radius: f32, is_solid: bool) {
    let extent = IVec3::splat(radius as i32);
    let (lo, hi) = ((center - extent).max(IVec3::ZERO), (center + extent).min(size - 1));
    for z in lo.z..=hi.z {
        for y in lo.y..=hi.y {
            let (dy, dz) = ((y - center.y) as f32, (z - center.z) as f32);
            let half = radius * radius - dy * dy - dz * dz;
            if half < 0.0 {
                continue;
            }
            let half = half.sqrt() as i32;
            let row = size.x * (y + size.y * z);
            let (from, to) = ((center.x - half).max(0), (center.x + half).min(size.x - 1));
            for s in &mut known[(row + from) as usize..=(row + to) as usize] {
                s.get_or_insert(is_solid);
            }
        }
    }
}

struct Island {
    solid: bool,
    /// Whether the island reaches the border of the grid.
    border: bool,
    nodes: Vec<u32>,
}

/// Returns the pieces of solid and of air that are connected along the axes.
fn islands(grid: &SdfGrid, solid: &[bool]) -> Vec<Island> {
    let size = grid.size;
    let steps = [1, size.x, size.x * size.y];
    let mut visited = vec![false; solid.len()];
    let mut islands = Vec::new();
    for start in 0..solid.len() as u32 {
        if visited[start as usize] {
            continue;
        }
        visited[start as usize] = true;
        let mut island = Island { solid: solid[start as usize], border: false, nodes: vec![start] };
        let mut next = 0;
        while let Some(&i) = island.nodes.get(next) {
            next += 1;
            let c = [i % size.x, i / size.x % size.y, i / steps[2]];
            for axis in 0..3 {
                let last = size[axis] - 1;
                island.border |= c[axis] == 0 || c[axis] == last;
                let below = (c[axis] > 0).then(|| i - steps[axis]);
                let above = (c[axis] < last).then(|| i + steps[axis]);
                for n in [below, above].into_iter().flatten() {
                    if !visited[n as usize] && solid[n as usize] == island.solid {
                        visited[n as usize] = true;
                        island.nodes.push(n);
                    }
                }
            }
        }
        islands.push(island);
    }
    islands
}

/// Returns whether any node around `p` is solid, and whether any is air: the 64 nodes of its cell and the cells next to
/// it.
pub fn around(grid: &SdfGrid, solid: &[bool], p: Vec3) -> (bool, bool) {
    let size = grid.size.as_ivec3();
    let base = ((p - grid.origin) / grid.cell).floor().as_ivec3();
    let (lo, hi) = ((base - 1).clamp(IVec3::ZERO, size - 1), (base + 2).clamp(IVec3::ZERO, size - 1));
    let (mut some_solid, mut some_air) = (false, false);
    for z in lo.z..=hi.z {
        for y in lo.y..=hi.y {
            for x in lo.x..=hi.x {
                let s = solid[(x + size.x * (y + size.y * z)) as usize];
                some_solid |= s;
                some_air |= !s;
            }
        }
    }
    (some_solid, some_air)
}
