//! Skin around the parts of a skinned body, which determines which distance fields deform.
//!
//! A part follows a joint. Its skin deviates from it where other joints carry a share of it, and where blend shapes
//! move it. There, its field deforms (`collide::deform` of the crate `tresses`). Fields of neighboring parts overlap
//! where they meet, so the skin of a part extends [`MARGIN`] farther than the part itself, along the surface: an arm
//! that hangs beside a chest is not part of the chest's skin.

use super::{Anatomy, PartForm, by_node, owners};
use crate::{TriMesh, mesh::weld_map};

/// Distance beyond a part up to which skin belongs to it, along edges, meters.
const MARGIN: f32 = 0.04;

/// Triangles around the head's field, then around those of the other solids. Empty for a part that its skin follows
/// rigidly.
#[derive(Clone, Debug, Default)]
pub struct Flesh(Vec<Vec<[u32; 3]>>);

impl Flesh {
    /// Collects the skin of a body with the mesh `mesh`; `has_head` is whether the head is a field at all. `is_free` is
    /// whether vertices move in other ways than the rig says, so that no part is rigid.
    pub fn new(anatomy: &Anatomy, mesh: &TriMesh, has_head: bool, is_free: bool) -> Self {
        let rig = &anatomy.rig;
        let head = anatomy.head.node;
        let owners = owners(rig, head);
        let of = |vertex: u32| owners[vertex as usize];
        let mut shaped = vec![false; rig.vertices.len()];
        for delta in rig.targets.iter().flat_map(|target| &target.deltas) {
            shaped[delta.vertex as usize] = true;
        }
        let leaves = |node: u32, vertex: u32| {
            let bind = &rig.vertices[vertex as usize];
            let carriers = bind.joints.iter().zip(&bind.weights).filter(|(_, weight)| **weight > 0.0);
            let joint = |joint: &u16| rig.joints.get(usize::from(*joint)).map(|joint| joint.node);
            shaped[vertex as usize] || carriers.filter_map(|(it, _)| joint(it)).any(|it| it != node)
        };
        let surface = Surface::new(mesh);
        let own = by_node(mesh, of);
        let around = |node: u32| {
            let own = own.get(&node).map_or(&[][..], |own| own);
            match own.iter().flatten().any(|vertex| is_free || leaves(node, *vertex)) {
                true => surface.triangles_within_margin(mesh, |vertex| of(vertex) == node),
                false => Vec::new(),
            }
        };
        let parts = anatomy.solids().map(|part| match part.form {
            PartForm::Field => around(part.node),
            _ => Vec::new(),
        });
        let head = if has_head { around(head) } else { Vec::new() };
        Self(std::iter::once(head).chain(parts).collect())
    }

    /// Iterates over the triangles around each field, the head first.
    pub fn around(&self) -> impl Iterator<Item = &[[u32; 3]]> {
        self.0.iter().map(Vec::as_slice)
    }

    /// Returns whether each of the fields deforms.
    pub fn deforms(&self) -> Vec<bool> {
        self.0.iter().map(|triangles| !triangles.is_empty()).collect()
    }
}

/// A mesh as a surface: vertices at the same position are one.
struct Surface {
    /// Vertex that represents each vertex.
    same: Vec<u32>,
    /// Neighbors of each vertex that represents others.
    neighbors: Vec<Vec<u32>>,
}

impl Surface {
    fn new(mesh: &TriMesh) -> Self {
        let same = weld_map(&mesh.positions);
        let mut neighbors = vec![Vec::new(); same.len()];
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| same[vertex as usize]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                neighbors[from as usize].push(to);
                neighbors[to as usize].push(from);
            }
        }
        Self { same, neighbors }
    }

    /// Returns the triangles within [`MARGIN`] of a part's own vertices.
    fn triangles_within_margin(&self, mesh: &TriMesh, is_own: impl Fn(u32) -> bool) -> Vec<[u32; 3]> {
        let mut far = vec![f32::INFINITY; self.same.len()];
        let mut edge = Vec::new();
        for vertex in 0..self.same.len() as u32 {
            let stands = self.same[vertex as usize];
            if is_own(vertex) && far[stands as usize] > 0.0 {
                far[stands as usize] = 0.0;
                edge.push(stands);
            }
        }
        // Relax ring by ring until no shorter path is found.
        while !edge.is_empty() {
            let mut next = Vec::new();
            for from in edge {
                for to in &self.neighbors[from as usize] {
                    let step = mesh.positions[from as usize].distance(mesh.positions[*to as usize]);
                    let path_length = far[from as usize] + step;
                    if path_length < MARGIN && path_length < far[*to as usize] {
                        far[*to as usize] = path_length;
                        next.push(*to);
                    }
                }
            }
            edge = next;
        }
        let is_near = |vertex: &u32| far[self.same[*vertex as usize] as usize] < MARGIN;
        mesh.triangles.iter().filter(|triangle| triangle.iter().any(is_near)).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn skin_extends_along_the_surface() {
        // Two strips of squares of 1 cm, 1 mm apart, with a seam at each square.
        let mut mesh = TriMesh::default();
        for z in [0.0, 0.001] {
            for i in 0..20u32 {
                let first = mesh.positions.len() as u32;
                let x = |k: u32| 0.01 * (i + k) as f32;
                for (k, y) in [(0, 0.0), (1, 0.0), (0, 0.01), (1, 0.01)] {
                    mesh.positions.push(Vec3::new(x(k), y, z));
                }
                mesh.triangles.extend([[0, 1, 2], [2, 1, 3]].map(|t| t.map(|v| v + first)));
            }
        }
        let surface = Surface::new(&mesh);
        let own = |vertex: u32| vertex < 4;
        let near = surface.triangles_within_margin(&mesh, own);
        let middle = |t: &[u32; 3]| t.iter().map(|v| mesh.positions[*v as usize]).sum::<Vec3>() / 3.0;
        assert!(near.iter().all(|t| middle(t).z == 0.0 && middle(t).x < 0.06), "not through the air");
        assert!(near.iter().any(|t| middle(t).x > 0.03), "across seams");
    }
}
