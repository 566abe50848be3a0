//! The skin around the parts of a body that bends: which of their distance fields deform with it, and with what of it.
//!
//! A part goes with a joint. Its skin leaves it where other joints carry some of it, and where shapes move it: there its
//! field deforms (`collide::deform` of the crate `tresses`). Fields of neighbours overlap where they meet, so the skin of a part is
//! taken [`BEYOND`] farther than the part itself, along the surface: an arm that hangs beside a chest is none of its skin.

use super::{Anatomy, PartForm, by_node, owners};
use crate::{TriMesh, mesh::places};

/// How far beyond a part skin counts as its, along edges, metres.
const BEYOND: f32 = 0.04;

/// The triangles around the head's field, then around those of the other solids: none where the skin goes with the part.
#[derive(Clone, Debug, Default)]
pub struct Flesh(Vec<Vec<[u32; 3]>>);

impl Flesh {
    /// Of a body whose mesh is `mesh`; `has_head`: whether the head is a field at all.
    pub fn new(anatomy: &Anatomy, mesh: &TriMesh, has_head: bool) -> Self {
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
            match own.iter().flatten().any(|vertex| leaves(node, *vertex)) {
                true => surface.beyond(mesh, |vertex| of(vertex) == node),
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

    /// The triangles around each of them, the head first.
    pub fn around(&self) -> impl Iterator<Item = &[[u32; 3]]> {
        self.0.iter().map(Vec::as_slice)
    }

    /// Whether each of them deforms.
    pub fn deforms(&self) -> Vec<bool> {
        self.0.iter().map(|triangles| !triangles.is_empty()).collect()
    }
}

/// A mesh as a surface: vertices at one place are one.
struct Surface {
    /// The vertex that stands for each.
    same: Vec<u32>,
    /// Of those that stand for others.
    neighbours: Vec<Vec<u32>>,
}

impl Surface {
    fn new(mesh: &TriMesh) -> Self {
        let same = places(&mesh.positions);
        let mut neighbours = vec![Vec::new(); same.len()];
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| same[vertex as usize]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                neighbours[from as usize].push(to);
                neighbours[to as usize].push(from);
            }
        }
        Self { same, neighbours }
    }

    /// The triangles within [`BEYOND`] of the vertices that are a part's own.
    fn beyond(&self, mesh: &TriMesh, is_own: impl Fn(u32) -> bool) -> Vec<[u32; 3]> {
        let mut far = vec![f32::INFINITY; self.same.len()];
        let mut edge = Vec::new();
        for vertex in 0..self.same.len() as u32 {
            let stands = self.same[vertex as usize];
            if is_own(vertex) && far[stands as usize] > 0.0 {
                far[stands as usize] = 0.0;
                edge.push(stands);
            }
        }
        // Ring by ring, as often as a shorter way is found.
        while !edge.is_empty() {
            let mut next = Vec::new();
            for from in edge {
                for to in &self.neighbours[from as usize] {
                    let step = mesh.positions[from as usize].distance(mesh.positions[*to as usize]);
                    let way = far[from as usize] + step;
                    if way < BEYOND && way < far[*to as usize] {
                        far[*to as usize] = way;
                        next.push(*to);
                    }
                }
            }
            edge = next;
        }
        let is_near = |vertex: &u32| far[self.same[*vertex as usize] as usize] < BEYOND;
        mesh.triangles.iter().filter(|triangle| triangle.iter().any(is_near)).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn skin_is_followed_along_the_surface() {
        // Two strips of squares of 1 cm, 1 mm apart; the first has a seam.
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
        let near = surface.beyond(&mesh, own);
        let middle = |t: &[u32; 3]| t.iter().map(|v| mesh.positions[*v as usize]).sum::<Vec3>() / 3.0;
        assert!(near.iter().all(|t| middle(t).z == 0.0 && middle(t).x < 0.06), "not through the air");
        assert!(near.iter().any(|t| middle(t).x > 0.03), "across seams");
    }
}
