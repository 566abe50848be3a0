//! Points in space: nearest neighbors, and an order in which neighbors are near each other.

use glam::{UVec3, Vec3};
use std::borrow::Cow;

/// Points in a balanced k-d tree: the median of every part of [`order`](Self::order) splits it along the axis of its
/// largest extent.
#[derive(Debug)]
pub(crate) struct PointTree<'a> {
    points: Cow<'a, [Vec3]>,
    order: Vec<u32>,
    axes: Vec<u8>,
}

impl<'a> PointTree<'a> {
    pub(crate) fn new(points: impl Into<Cow<'a, [Vec3]>>) -> Self {
        let points = points.into();
        let (order, axes) = ((0..points.len() as u32).collect(), vec![0; points.len()]);
        let mut near = Self { points, order, axes };
        let points = &near.points;
        let mut parts = Vec::from([(0, points.len())]);
        while let Some((start, end)) = parts.pop() {
            let part = start..end;
            if part.len() < 2 {
                continue;
            }
            let order = &mut near.order[part.clone()];
            let (lo, hi) = order.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &i| {
                let p = points[i as usize];
                (lo.min(p), hi.max(p))
            });
            let axis = (hi - lo).max_position();
            let median = order.len() / 2;
            let key = |i: u32| points[i as usize][axis];
            order.select_nth_unstable_by(median, |a, b| key(*a).total_cmp(&key(*b)).then(a.cmp(b)));
            near.axes[part.start + median] = axis as u8;
            parts.push((start, start + median));
            parts.push((start + median + 1, end));
        }
        near
    }

    /// Returns the index of the point nearest to `p`, if there are points.
    pub(crate) fn closest(&self, p: Vec3) -> Option<usize> {
        let mut found = Vec::new();
        self.nearest(p, 1, f32::MAX, &mut found);
        found.first().map(|(_, i)| *i as usize)
    }

    /// Puts the `count` points nearest to `p` and nearer than `max_distance` meters into `found`, nearest first, as
    /// squared distances and indices.
    pub(crate) fn nearest(&self, p: Vec3, count: usize, max_distance: f32, found: &mut Vec<(f32, u32)>) {
        found.clear();
        let mut max_squared = max_distance * max_distance;
        let mut parts: Vec<(std::ops::Range<usize>, f32)> = vec![(0..self.order.len(), 0.0)];
        while let Some((part, min_squared)) = parts.pop() {
            if part.is_empty() || min_squared > max_squared {
                continue;
            }
            let median = part.start + part.len() / 2;
            let i = self.order[median];
            let q = self.points[i as usize];
            let d = q.distance_squared(p);
            if d <= max_squared {
                let at = found.partition_point(|f| (f.0, f.1) < (d, i));
                found.insert(at, (d, i));
                found.truncate(count);
                if found.len() == count {
                    max_squared = found[count - 1].0;
                }
            }
            let axis = usize::from(self.axes[median]);
            let across = p[axis] - q[axis];
            let (low, high) = (part.start..median, median + 1..part.end);
            let (near, far) = if across < 0.0 { (low, high) } else { (high, low) };
            parts.push((far, across * across));
            parts.push((near, 0.0));
        }
    }
}

/// Returns the Morton code of a cell: the lower ten bits of each axis, interleaved.
pub(crate) fn morton(cell: UVec3) -> u32 {
    let spread = |v: u32| (0..10).fold(0, |bits, i| bits | (v >> i & 1) << (3 * i));
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Rng;

    #[test]
    fn nearest_points_match_brute_force() {
        let mut rng = Rng::new(4, 1);
        let points: Vec<Vec3> = (0..500).map(|_| rng.bell3()).collect();
        let near = PointTree::new(&points);
        let mut found = Vec::new();
        for _ in 0..200 {
            let p = 1.2 * rng.bell3();
            let mut all: Vec<(f32, u32)> =
                (0u32..).zip(&points).map(|(i, q)| (q.distance_squared(p), i)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            near.nearest(p, 9, 1.0, &mut found);
            all.truncate(9);
            all.retain(|(d, _)| *d <= 1.0);
            assert_eq!(found, all);
        }
        PointTree::new(&[]).nearest(Vec3::ZERO, 3, 1.0, &mut found);
        assert!(found.is_empty());
    }
}
