//! Connected parts of a mesh.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::TriMesh;

/// A connected part of a mesh: triangles that share vertices or vertex positions.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshPart {
    /// Indices into the mesh's `triangles`, ascending.
    pub triangles: Vec<u32>,
    /// Surface area, square meters.
    pub area: f32,
    /// Enclosed volume, cubic meters, negative if inverted. Meaningless for an open part, where it depends on the
    /// position.
    pub volume: f32,
    /// Whether every edge is used as often in one direction as in the other, so that the part has an inside.
    pub closed: bool,
}

impl MeshPart {
    /// Returns the mean thickness of a closed part, meters: the thickness of a plate, two thirds of the radius of a
    /// ball. 0 for an open part.
    pub fn thickness(&self) -> f32 {
        if self.closed && self.area > 0.0 { 2.0 * self.volume.abs() / self.area } else { 0.0 }
    }
}

impl TriMesh {
    /// Returns the connected parts, the one with the largest surface first. Triangles with an index out of range belong
    /// to none.
    pub fn parts(&self) -> Vec<MeshPart> {
        let weld = weld_map(&self.positions);
        let mut groups = Groups((0..weld.len() as u32).collect());
        let valid = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < weld.len());
        let welded = |t: &[u32; 3]| t.map(|v| weld[v as usize]);
        for t in self.triangles.iter().filter(|t| valid(t)).map(welded) {
            groups.join(t[0], t[1]);
            groups.join(t[0], t[2]);
        }
        let mut of = HashMap::new();
        let mut parts: Vec<Vec<u32>> = Vec::new();
        for (i, t) in self.triangles.iter().enumerate().filter(|(_, t)| valid(t)) {
            let part = *of.entry(groups.root(weld[t[0] as usize])).or_insert_with(|| {
                parts.push(Vec::new());
                parts.len() - 1
            });
            parts[part].push(i as u32);
        }
        let mut parts: Vec<MeshPart> = parts.into_iter().map(|t| self.measure(t, &weld)).collect();
        parts.sort_by(|a, b| b.area.total_cmp(&a.area));
        parts
    }

    fn measure(&self, triangles: Vec<u32>, weld: &[u32]) -> MeshPart {
        let (mut area, mut volume) = (0.0, 0.0);
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        let corner = |v: u32| self.positions[v as usize].as_dvec3();
        let origin = triangles.first().map_or(DVec3::ZERO, |&i| corner(self.triangles[i as usize][0]));
        for &i in &triangles {
            let t = self.triangles[i as usize];
            let [a, b, c] = t.map(|v| corner(v) - origin);
            area += 0.5 * (b - a).cross(c - a).length();
            volume += a.dot(b.cross(c)) / 6.0;
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let (from, to) = (weld[t[from] as usize], weld[t[to] as usize]);
                *edges.entry((from.min(to), from.max(to))).or_default() +=
                    (to > from) as i32 - (to < from) as i32;
            }
        }
        let closed = edges.values().all(|&balance| balance == 0);
        MeshPart { triangles, area: area as f32, volume: volume as f32, closed }
    }
}

/// Returns for every vertex the first one at the same position.
pub fn weld_map(positions: &[Vec3]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    // Adding 0 makes a negative zero positive, so that equal positions have equal bits.
    let key = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    positions.iter().enumerate().map(|(i, p)| *first.entry(key(*p)).or_insert(i as u32)).collect()
}

/// Disjoint sets as trees with path halving.
struct Groups(Vec<u32>);

impl Groups {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let up = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = up;
            i = up;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes;
    use super::*;

    #[test]
    fn parts_are_found_and_measured() {
        let mut open = shapes::sphere(0.5, 12);
        open.positions.iter_mut().for_each(|p| p.x += 5.0);
        open.triangles.truncate(400);
        let all = TriMesh::merge(&[
            open,
            shapes::inverted(shapes::torus(2.0, 0.5, 48)),
            shapes::cuboid(Vec3::splat(0.1)),
        ]);
        let parts = all.parts();
        assert_eq!(parts.len(), 3);
        assert_eq!(parts.iter().map(|p| p.triangles.len()).sum::<usize>(), all.triangles.len());
        assert_eq!(parts.iter().map(|p| p.closed).collect::<Vec<_>>(), [true, false, true]);
        let pi2 = std::f32::consts::PI.powi(2);
        assert!(
            (parts[0].volume + 2.0 * pi2 * 2.0 * 0.25).abs() < 0.1 && (parts[0].area - 4.0 * pi2).abs() < 0.3
        );
        assert!((parts[2].thickness() - 0.2 / 3.0).abs() < 1e-5);
        assert_eq!(parts[1].thickness(), 0.0);
    }
}
