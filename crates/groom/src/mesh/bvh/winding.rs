//! Generalized winding number: near triangles exactly, far nodes as dipoles.
//! Source: Barill, Dickson, Schmidt, Levin, Jacobson: Fast Winding Numbers for Soups and Clouds, 2018.

use std::f32::consts::TAU;

use glam::Vec3;

use super::{Bvh, DEPTH, Node};
use crate::mesh::triangle::SolidAngle;

/// Far-field approximation of a node's triangles.
#[derive(Clone, Copy, Debug)]
pub struct NodeMoment {
    /// Centroid, weighted by area.
    pub center: Vec3,
    /// Squared distance from the center to the farthest corner of the box.
    pub radius: f32,
    /// Sum of the triangles' area vectors.
    pub area: Vec3,
}

/// Distance, in radii of a node, beyond which the node is a dipole. At 2.5 the error of the sum over a closed shape is
/// at most 0.04 (see the tests), far from the threshold between inside and outside.
const FAR: f32 = 2.5;

impl Bvh {
    /// Returns the winding number of the mesh around `p`: the solid angle of the mesh, divided by that of the whole
    /// sphere.
    ///
    /// For a closed mesh whose triangles run counterclockwise seen from outside, it is 1 inside and 0 outside (-1
    /// inside if inverted); overlapping parts add up. Across a hole it changes smoothly from 1 to 0 and is 0.5 on the
    /// flat disc that closes the hole, so `> 0.5` is the solid with its holes filled. A sheet has less than 0.5 on
    /// either side. 0 without triangles.
    pub fn winding_number(&self, p: Vec3) -> f32 {
        self.winding_with(p, FAR)
    }

    /// Returns the winding number, with nodes `far` radii away as dipoles.
    pub(crate) fn winding_with(&self, p: Vec3, far: f32) -> f32 {
        let limit = far * far;
        let (mut dipoles, mut near) = (0.0, SolidAngle::ZERO);
        let mut stack = [0u32; DEPTH + 1];
        let mut top = usize::from(!self.is_empty());
        while top > 0 {
            top -= 1;
            let at = stack[top];
            let (node, moment) = (&self.nodes[at as usize], &self.moments[at as usize]);
            let to = moment.center - p;
            let squared = to.length_squared();
            if squared > limit * moment.radius {
                dipoles += to.dot(moment.area) / (squared * squared.sqrt());
            } else if node.count == 0 {
                stack[top] = at + 1;
                stack[top + 1] = node.first;
                top += 2;
            } else {
                let leaf = node.first as usize..(node.first + node.count) as usize;
                self.corners[leaf].iter().for_each(|c| near.add(p, *c));
            }
        }
        (dipoles + near.total()) / (2.0 * TAU)
    }
}

/// Computes the moments of all nodes. Children come after their parents, so the sums start from the back.
pub fn moments(nodes: &[Node], corners: &[[Vec3; 3]]) -> Vec<NodeMoment> {
    // Area vector, area times centroid, area.
    let mut sums = vec![(Vec3::ZERO, Vec3::ZERO, 0.0f32); nodes.len()];
    for i in (0..nodes.len()).rev() {
        let node = nodes[i];
        sums[i] = if node.count == 0 {
            let (l, r) = (sums[i + 1], sums[node.first as usize]);
            (l.0 + r.0, l.1 + r.1, l.2 + r.2)
        } else {
            let leaf = &corners[node.first as usize..(node.first + node.count) as usize];
            leaf.iter().fold(sums[i], |(vector, centroid, area), [a, b, c]| {
                let own = 0.5 * (*b - *a).cross(*c - *a);
                let size = own.length();
                (vector + own, centroid + (*a + *b + *c) / 3.0 * size, area + size)
            })
        };
    }
    let moment = |(node, (area, centroid, size)): (&Node, (Vec3, Vec3, f32))| {
        let center = if size > 0.0 { centroid / size } else { 0.5 * (node.lo + node.hi) };
        let radius = (node.hi - center).max(center - node.lo).length();
        NodeMoment { center, area, radius: radius * radius }
    };
    nodes.iter().zip(sums).map(moment).collect()
}
