//! Caps: boundaries between solid and air without triangles, at openings and over dropped pieces.
//!
//! A cap lies where the winding number is 0.5. The distances next to it follow from its intersections with the grid's
//! edges. All others follow from those by the eikonal equation `|grad d| = 1`, solved by sweeps in the eight diagonal
//! directions (Zhao, A Fast Sweeping Method for Eikonal Equations, 2005).

use glam::IVec3;

use super::Winding;
use crate::SdfGrid;

/// Lowers unsigned `distances` to the distances from the caps where these are smaller.
pub fn close(grid: &SdfGrid, field: &Winding<'_>, solid: &[bool], distances: &mut [f32]) {
    // In cells.
    let Some(mut cap_distances) = seeds(grid, field, solid, distances) else { return };
    for directions in 0..8 {
        sweep(&mut cap_distances, grid.size.as_ivec3(), directions);
    }
    for (distance, cap_distance) in distances.iter_mut().zip(cap_distances) {
        *distance = distance.min(cap_distance * grid.cell);
    }
}

/// Returns the distances in cells of the nodes next to a cap, infinite elsewhere, or `None` without caps.
fn seeds(grid: &SdfGrid, field: &Winding<'_>, solid: &[bool], distances: &[f32]) -> Option<Vec<f32>> {
    let steps = [1, grid.size.x, grid.size.x * grid.size.y];
    // For each node, the sum of 1/d² over the axes, where d is the distance to the nearer cut along the axis. The
    // distance to the plane through these cuts is 1/√sum.
    let mut sums: Vec<f32> = Vec::new();
    for (step, count) in steps.into_iter().zip(grid.size.to_array()) {
        // Nodes, and their distances to a cut.
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
            // Dropped specks and filled cavities have no crossing; their cap is halfway.
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

/// Updates `distances`, in cells, in one sweep. Bits 0 to 2 of `directions` reverse x, y and z.
fn sweep(distances: &mut [f32], size: IVec3, directions: i32) {
    let coordinate = |count: i32, i: i32, bit: i32| if directions & bit == 0 { i } else { count - 1 - i };
    let steps = IVec3::new(1, size.x, size.x * size.y);
    for k in 0..size.z {
        for j in 0..size.y {
            for i in 0..size.x {
                let node =
                    IVec3::new(coordinate(size.x, i, 1), coordinate(size.y, j, 2), coordinate(size.z, k, 4));
                let index = node.dot(steps);
                let nearer = |axis: usize| {
                    let below = if node[axis] > 0 {
                        distances[(index - steps[axis]) as usize]
                    } else {
                        f32::INFINITY
                    };
                    let above = if node[axis] < size[axis] - 1 {
                        distances[(index + steps[axis]) as usize]
                    } else {
                        f32::INFINITY
                    };
                    below.min(above)
                };
                let new = solve([nearer(0), nearer(1), nearer(2)]);
                if new < distances[index as usize] {
                    distances[index as usize] = new;
                }
            }
        }
    }
}

/// Returns the distance of a node, in cells, from `distances`, the smaller of its neighbors' along each axis: the
/// upwind solution of the eikonal equation. It depends on the nearest one, two or three neighbors.
fn solve(mut distances: [f32; 3]) -> f32 {
    distances.sort_by(f32::total_cmp);
    let [a, b, c] = distances;
    let from_one = a + 1.0;
    if from_one <= b {
        return from_one;
    }
    let from_two = 0.5 * (a + b + (2.0 - (a - b) * (a - b)).max(0.0).sqrt());
    if from_two <= c {
        return from_two;
    }
    let sum = a + b + c;
    (sum + (sum * sum - 3.0 * (a * a + b * b + c * c - 1.0)).max(0.0).sqrt()) / 3.0
}
