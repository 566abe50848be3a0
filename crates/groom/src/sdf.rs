//! Signed distance field on a regular grid, on the CPU: the collider of a head.

use glam::{UVec3, Vec3};

/// Signed distances (meters, negative inside) at the nodes of a regular grid in groom space.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct SdfGrid {
    /// Nodes along x, y and z.
    pub size: UVec3,
    /// Position of node (0, 0, 0), meters.
    pub origin: Vec3,
    /// Distance between neighboring nodes, meters.
    pub cell: f32,
    /// Distances, x fastest.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub distances: Vec<f32>,
}

impl SdfGrid {
    /// Returns a grid that covers `lo..hi` with `resolution` nodes along the longest axis, filled by `distance`.
    pub fn from_fn(lo: Vec3, hi: Vec3, resolution: u32, distance: impl Fn(Vec3) -> f32) -> Self {
        let mut grid = Self::over(lo, hi, resolution);
        grid.distances = (0..grid.size.element_product()).map(|i| distance(grid.node(i))).collect();
        grid
    }

    /// [`from_fn`](Self::from_fn) without distances.
    pub(crate) fn over(lo: Vec3, hi: Vec3, resolution: u32) -> Self {
        let cell = (hi - lo).max_element() / (resolution.max(2) - 1) as f32;
        let size = ((hi - lo) / cell).ceil().as_uvec3() + UVec3::ONE;
        Self { size, origin: lo, cell, distances: Vec::new() }
    }

    /// Returns the position of node `i`, meters.
    pub fn node(&self, i: u32) -> Vec3 {
        let (x, y, z) = (i % self.size.x, i / self.size.x % self.size.y, i / (self.size.x * self.size.y));
        self.origin + Vec3::new(x as f32, y as f32, z as f32) * self.cell
    }

    /// Returns the distance at `p`, meters: trilinear inside the grid. Outside, it is the distance at the closest point
    /// of the grid's box plus the distance to that point.
    pub fn sample(&self, p: Vec3) -> f32 {
        let last = (self.size - UVec3::ONE).as_vec3();
        let local = (p - self.origin) / self.cell;
        let q = local.clamp(Vec3::ZERO, last);
        // No coordinate is below 0, so a conversion rounds down.
        let base = q.as_uvec3().min(self.size.saturating_sub(UVec3::splat(2)));
        let f = q - base.as_vec3();
        let [sx, sy, sz] = self.size.to_array().map(|size| size as usize);
        // An axis with a single node has no next one.
        let [dx, dy, dz] =
            [(sx, 1), (sy, sx), (sz, sx * sy)].map(|(size, step)| if size > 1 { step } else { 0 });
        let [x, y, z] = base.to_array().map(|index| index as usize);
        let first = x + sx * (y + sy * z);
        // Plain lines: the functional form is not inlined, and takes twice the time.
        let d = &self.distances[..];
        let next = first + dz;
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let near = mix(mix(d[first], d[first + dx], f.x), mix(d[first + dy], d[first + dy + dx], f.x), f.y);
        let far = mix(mix(d[next], d[next + dx], f.x), mix(d[next + dy], d[next + dy + dx], f.x), f.y);
        mix(near, far, f.z) + (local - q).length() * self.cell
    }

    /// Returns the distance along a ray (`direction` unit) to the surface that is `thickness` meters above the
    /// obstacle, by sphere tracing; `None` if there is none within 20 m.
    pub fn trace(&self, origin: Vec3, direction: Vec3, thickness: f32) -> Option<f32> {
        let mut t = 0.0;
        for _ in 0..200 {
            let distance = self.sample(origin + direction * t) - thickness;
            if distance < 5e-4 {
                return Some(t);
            }
            t += distance;
            if t > 20.0 {
                break;
            }
        }
        None
    }

    /// Returns the normalized gradient of the distance at `p`, which points away from the obstacle.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        let h = 0.5 * self.cell;
        let d = |axis: Vec3| self.sample(p + axis * h) - self.sample(p - axis * h);
        Vec3::new(d(Vec3::X), d(Vec3::Y), d(Vec3::Z)).normalize_or(Vec3::Y)
    }

    /// Returns [`Self::normal`] at every node, x fastest: eight times as fast as separate calls.
    pub fn node_normals(&self) -> impl Iterator<Item = Vec3> + '_ {
        let n = self.size;
        let step = [1, n.x, n.x * n.y];
        (0..n.element_product()).map(move |i| {
            let at = [i % n.x, i / n.x % n.y, i / (n.x * n.y)];
            let d = |j: u32| self.distances[j as usize];
            // Half a cell outside of the grid, distances continue as in `sample`.
            let side = |axis: usize, up: bool| match up {
                true if at[axis] + 1 < n[axis] => 0.5 * (d(i) + d(i + step[axis])),
                false if at[axis] > 0 => 0.5 * (d(i) + d(i - step[axis])),
                _ => d(i) + 0.5 * self.cell,
            };
            let along = |axis| side(axis, true) - side(axis, false);
            Vec3::new(along(0), along(1), along(2)).normalize_or(Vec3::Y)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampled_sphere_matches_closed_form() {
        let grid = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 33, |p| p.length() - 0.1);
        for p in [Vec3::new(0.12, 0.03, -0.05), Vec3::new(0.05, 0.0, 0.04), Vec3::new(0.5, 0.0, 0.0)] {
            assert!((grid.sample(p) - (p.length() - 0.1)).abs() < 2e-3, "{p}");
        }
        assert!(grid.normal(Vec3::new(0.0, 0.11, 0.0)).dot(Vec3::Y) > 0.999);
    }

    #[test]
    fn node_normals_match_point_normals() {
        let grid = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::new(0.2, 0.1, 0.15), 17, |p| {
            p.length() - 0.1 + 0.01 * (40.0 * p.x).sin()
        });
        let worst = |off: f32| {
            let differ =
                |(i, n): (usize, Vec3)| n.distance(grid.normal(grid.node(i as u32) + Vec3::splat(off)));
            grid.node_normals().enumerate().map(differ).fold(0.0, f32::max)
        };
        assert!(worst(0.0) < 1e-4, "{}", worst(0.0));
        assert!(worst(2e-3) > 1e-2, "normals of other places pass");
    }
}
