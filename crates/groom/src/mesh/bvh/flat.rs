//! The tree as a flat list that is traversed without a stack, as on a GPU.

use super::Bvh;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A node of the tree, in depth-first order.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct TreeNode {
    /// Minimum corner of the box, meters.
    pub low: Vec3,
    /// First triangle of a leaf. For an inner node, the second child; the first child is the next node.
    pub first: u32,
    /// Maximum corner of the box, meters.
    pub high: Vec3,
    /// Number of triangles of a leaf; 0 for an inner node.
    pub count: u32,
    /// Centroid of the triangles, weighted by area.
    pub center: Vec3,
    /// Distance from `center` to the farthest corner of the box, meters.
    pub radius: f32,
    /// Sum of the triangles' area vectors, m².
    pub area: Vec3,
    /// Next node outside of this node's subtree.
    pub skip: u32,
}

impl Bvh {
    /// Returns the nodes, depth first, and the corners of the triangles, three each, in the order of the leaves.
    pub fn flat(&self) -> (Vec<TreeNode>, Vec<[f32; 4]>) {
        let mut skips = vec![self.nodes.len() as u32; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            if node.count == 0 {
                skips[i + 1] = node.first;
                skips[node.first as usize] = skips[i];
            }
        }
        let nodes = self.nodes.iter().zip(&self.moments).zip(skips).map(|((node, moment), skip)| TreeNode {
            low: node.lo,
            first: node.first,
            high: node.hi,
            count: node.count,
            center: moment.center,
            radius: moment.radius.sqrt(),
            area: moment.area,
            skip,
        });
        (nodes.collect(), self.corners.iter().flatten().map(|p| p.extend(0.0).into()).collect())
    }
}
