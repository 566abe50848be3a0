//! Closest-point query: visits the nearer child first and skips boxes farther than the best point so far.

use glam::Vec3;

use super::{Bvh, DEPTH};
use crate::mesh::triangle;

/// Point of a mesh closest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Position, meters.
    pub point: Vec3,
    /// Distance from the query point, meters, never negative.
    pub distance: f32,
    /// Triangle that the point lies on: an index into the mesh's `triangles`.
    pub triangle: u32,
    /// Barycentric weights of the triangle's corners: none negative, sum 1.
    pub barycentric: Vec3,
}

impl Bvh {
    /// Returns the point of the mesh closest to `p`, or `None` without triangles or for a `p` that is not finite.
    pub fn closest_point(&self, p: Vec3) -> Option<Closest> {
        self.closest_point_within(p, f32::INFINITY)
    }

    /// Returns the point of the mesh closest to `p` if it is nearer than `radius` meters. A smaller radius is faster.
    pub fn closest_point_within(&self, p: Vec3, radius: f32) -> Option<Closest> {
        self.nearest(p, radius * radius, None, 0.0).map(|(_, closest)| closest)
    }

    /// [`closest_point_within`](Self::closest_point_within) with the squared radius. The search starts from the
    /// triangle at `hint` in the order of the leaves. Also returns the place of the result in that order. The distance
    /// may be too large by the fraction `error`.
    pub(crate) fn nearest(
        &self,
        p: Vec3,
        radius: f32,
        hint: Option<u32>,
        error: f32,
    ) -> Option<(u32, Closest)> {
        let mut best = ClosestHit {
            p,
            squared: radius,
            bound: radius,
            shrink: (1.0 - error) * (1.0 - error),
            found: None,
        };
        if let Some(slot) = hint {
            best.offer(slot, self.corners[slot as usize]);
        }
        let mut stack = [(0u32, 0.0f32); DEPTH];
        let mut top = 0;
        let mut at = 0u32;
        let mut lower = self.nodes.first()?.distance_squared(p);
        loop {
            // This comparison visits nothing if `p` is NaN.
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

struct ClosestHit {
    p: Vec3,
    squared: f32,
    /// Squared distance from which on boxes are skipped.
    bound: f32,
    shrink: f32,
    found: Option<(u32, Vec3, Vec3)>,
}

impl ClosestHit {
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
