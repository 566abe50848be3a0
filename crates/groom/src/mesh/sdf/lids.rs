//! Lids: boundaries between solid and air without triangles, at openings and over dropped pieces.
//!
//! The lid lies where the winding number is 0.5. The distances next to it follow from its intersections with the grid's
//! edges. All others follow from those by the eikonal equation `|grad d| = 1`, solved by sweeps in the eight diagonal
//! directions (Zhao, A Fast Sweeping Method for Eikonal Equations, 2005).

use glam::IVec3;

use super::Winding;
use crate::SdfGrid;

/// Lowers unsigned `distances` to the distances from the lids where these are smaller.
pub fn close(grid: &SdfGrid, field: &Winding<'_>, solid: &[bool], distances: &mut [f32]) {
    let Some(mut cap_distances) = seeds(grid, field, solid, distances) else { return };
    // Distances in cells.
    for directions in 0..8 {
        sweep(&mut cap_distances, grid.size.as_ivec3(), directions);
    }
    for (d, l) in distances.iter_mut().zip(cap_distances) {
        *d = d.min(l * grid.cell);
    }
}

/// Returns the distances in cells of the nodes that touch a lid, infinite elsewhere, or `None` without lids.
fn seeds(grid: &SdfGrid, field: &Winding<'_>, solid: &[bool], distances: &[f32]) -> Option<Vec<f32>> {
    let steps = [1, grid.size.x, grid.size.x * grid.size.y];
    // Sums of 1 / d^2 over the axes, of the nearer cut on each: the distance of a plane from its intercepts.
    let mut sums: Vec<f32> = Vec::new();
    for (step, count) in steps.into_iter().zip(grid.size.to_array()) {
        let mut cuts: Vec<(u32, f32)> = Vec::new();
        for i in 0..solid.len() as u32 {
            let next = i + step;
            if i / step % count == count - 1 || solid[i as usize] == solid[next as usize] {
                continue;
            }
            // If a triangle crosses the edge, the distances of both ends sum to at most the length of the edge.
            if distances[i as usize] + distances[next as usize] <= 1.001 * grid.cell {
                continue;
            }
            let (a, b) = (field.at(grid.node(i)) - 0.5, field.at(grid.node(next)) - 0.5);
            // Dropped specks and filled cavities have no crossing; their lid is halfway.
            let t = if (a > 0.0) != (b > 0.0) { (a / (a - b)).clamp(0.02, 0.98) } else { 0.5 };
            cuts.extend([(i, t), (next, 1.0 - t)]);
        }
        if cuts.is_empty() {
            continue;
        }
        sums.resize(solid.len(), 0.0);
        cuts.sort_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap_or(std::cmp::Ordering::Equal));
        cuts.dedup_by_key(|cut| cut.0);
        cuts.iter().for_each(|&(i, t)| sums[i as usize] += 1.0 / (t * t));
    }
    (!sums.is_empty())
        .then(|| sums.iter().map(|s| if *s > 0.0 { 1.0 / s.sqrt() } else { f32::INFINITY }).collect())
}

fn sweep(d: &mut [f32], size: IVec3, directions: i32) {
    let at = |n: i32, i: i32, bit: i32| if directions & bit == 0 { i } else { n - 1 - i };
    let steps = IVec3::new(1, size.x, size.x * size.y);
    for k in 0..size.z {
        for j in 0..size.y {
            for i in 0..size.x {
                let c = IVec3::new(at(size.x, i, 1), at(size.y, j, 2), at(size.z, k, 4));
                let index = c.dot(steps);
                let nearer = |axis: usize| {
                    let below = if c[axis] > 0 { d[(index - steps[axis]) as usize] } else { f32::INFINITY };
                    let above = if c[axis] < size[axis] - 1 {
                        d[(index + steps[axis]) as usize]
                    } else {
                        f32::INFINITY
                    };
                    below.min(above)
                };
                let new = solve([nearer(0), nearer(1), nearer(2)]);
                if new < d[index as usize] {
                    d[index as usize] = new;
                }
            }
        }
    }
}

/// Returns the distance of a node from its neighbors' distances `n`, one cell away: the upwind solution of the eikonal
/// equation.
fn solve(mut n: [f32; 3]) -> f32 {
    n.sort_by(f32::total_cmp);
    let [a, b, c] = n;
    let one = a + 1.0;
    if one <= b {
        return one;
    }
    let two = 0.5 * (a + b + (2.0 - (a - b) * (a - b)).max(0.0).sqrt());
    if two <= c {
        return two;
    }
    let sum = a + b + c;
    (sum + (sum * sum - 3.0 * (a * a + b * b + c * c - 1.0)).max(0.0).sqrt()) / 3.0
}
