//! The nearest point: nearer child first, and pruning of everything farther than the best so far.

use glam::Vec3;

use super::{Bvh, DEPTH};
use crate::mesh::triangle;

/// The point of a mesh nearest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The point, metres.
    pub point: Vec3,
    /// Its distance, metres, never negative.
    pub distance: f32,
    /// The triangle it lies on: an index into the mesh's `triangles`.
    pub triangle: u32,
    /// Its weights of the triangle's corners: none negative, sum 1.
    pub barycentric: Vec3,
}

impl Bvh {
    /// The point of the mesh nearest to `p`; `None` if there is no triangle or `p` is not finite.
    pub fn closest_point(&self, p: Vec3) -> Option<Closest> {
        self.closest_point_within(p, f32::INFINITY)
    }

    /// The point of the mesh nearest to `p` if it is nearer than `radius` metres: the smaller the
    /// radius, the faster.
    pub fn closest_point_within(&self, p: Vec3, radius: f32) -> Option<Closest> {
        self.nearest(p, radius * radius, None, 0.0).map(|(_, closest)| closest)
    }

    /// Like [`closest_point_within`](Self::closest_point_within) with the squared radius, starting from
    /// the triangle at `hint` in the order of the leaves, and also returning that place for the result,
    /// whose distance may be too large by the part `error` of itself.
    pub(crate) fn nearest(
        &self,
        p: Vec3,
        radius: f32,
        hint: Option<u32>,
        error: f32,
    ) -> Option<(u32, Closest)> {
        let mut best =
            Best { p, squared: radius, bound: radius, shrink: (1.0 - error) * (1.0 - error), found: None };
        if let Some(slot) = hint {
            best.offer(slot, self.corners[slot as usize]);
        }
        let mut stack = [(0u32, 0.0f32); DEPTH];
        let mut top = 0;
        let mut at = 0u32;
        let mut lower = self.nodes.first()?.distance_squared(p);
        loop {
            // Written so that a `p` that is not a number visits nothing.
            if lower < best.bound {
                let node = &self.nodes[at as usize];
                if node.count == 0 {
                    let (left, right) = (at + 1, node.first);
                    let l = self.nodes[left as usize].distance_squared(p);
                    let r = self.nodes[right as usize].distance_squared(p);
                    let far;
                    ((at, lower), far) =
                        if l <= r { ((left, l), (right, r)) } else { ((right, r), (left, l)) };
                    if far.1 < best.bound {
                        stack[top] = far;
                        top += 1;
                    }
                    continue;
                }
                for slot in node.first..node.first + node.count {
                    best.offer(slot, self.corners[slot as usize]);
                }
            }
            if top == 0 {
                break;
            }
            top -= 1;
            (at, lower) = stack[top];
        }
        let (slot, point, barycentric) = best.found?;
        let triangle = self.source[slot as usize];
        Some((slot, Closest { point, distance: best.squared.sqrt(), triangle, barycentric }))
    }
}

struct Best {
    p: Vec3,
    squared: f32,
    /// Boxes at least this far (squared) are not looked into.
    bound: f32,
    shrink: f32,
    found: Option<(u32, Vec3, Vec3)>,
}

impl Best {
    fn offer(&mut self, slot: u32, corners: [Vec3; 3]) {
        let (point, barycentric) = triangle::closest_point(self.p, corners);
        let squared = point.distance_squared(self.p);
        if squared < self.squared {
            self.squared = squared;
            self.bound = squared * self.shrink;
            self.found = Some((slot, point, barycentric));
        }
    }
}
