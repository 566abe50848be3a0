//! Bounding volume hierarchy over the triangles of a mesh, with two queries for a point: the closest point of the mesh,
//! and the winding number of the mesh around the point.
//!
//! One tree serves both. A node has its box for the first query and the sum of its triangles' area vectors for the
//! second; from far away, nothing else matters.

mod build;
mod closest;
mod flat;
#[cfg(test)]
mod tests;
mod winding;

use glam::Vec3;

use super::TriMesh;
pub use closest::Closest;
pub use flat::TreeNode;
use winding::NodeMoment;

/// A bounding volume hierarchy over the triangles of a mesh. It copies the data that it needs.
///
/// Triangles with an index out of range or a corner that is not finite are skipped. Triangles without area are kept as
/// segments or points.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    moments: Vec<NodeMoment>,
    /// Corners of the triangles in the order of the leaves.
    corners: Vec<[Vec3; 3]>,
    /// Indices of the triangles in the mesh.
    source: Vec<u32>,
}

/// A box. With `count > 0`, a leaf of that many triangles from `first` on; else the parent of the next node and of node
/// `first`.
#[derive(Clone, Copy, Debug)]
struct Node {
    lo: Vec3,
    first: u32,
    hi: Vec3,
    count: u32,
}

impl Node {
    fn distance_squared(&self, p: Vec3) -> f32 {
        (self.lo - p).max(p - self.hi).max(Vec3::ZERO).length_squared()
    }
}

/// Maximum depth of the tree, and so the stack size of a traversal that keeps one node per level.
const DEPTH: usize = 64;

impl Bvh {
    /// Builds the tree over the triangles of `mesh`.
    pub fn new(mesh: &TriMesh) -> Self {
        let corner = |i: u32| mesh.positions.get(i as usize).copied().filter(|p| p.is_finite());
        let mut source = Vec::with_capacity(mesh.triangles.len());
        let mut corners = Vec::with_capacity(mesh.triangles.len());
        for (i, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            if let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) {
                source.push(i as u32);
                corners.push([a, b, c]);
            }
        }
        let (nodes, order) = build::build(&corners);
        let corners: Vec<_> = order.iter().map(|&i| corners[i as usize]).collect();
        let source = order.iter().map(|&i| source[i as usize]).collect();
        let moments = winding::moments(&nodes, &corners);
        Self { nodes, moments, corners, source }
    }

    /// Returns whether the tree has no triangles.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Returns the minimum and maximum corner, or `None` without triangles.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.nodes.first().map(|root| (root.lo, root.hi))
    }
}
