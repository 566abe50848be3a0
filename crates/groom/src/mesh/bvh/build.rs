//! Construction: splits that minimize the surface area heuristic over a few bins.

use glam::Vec3;

use super::{DEPTH, Node};

const LEAF: usize = 4;
const BINS: usize = 12;

/// Returns the nodes, depth first, and the order of the triangles in their leaves.
pub fn build(corners: &[[Vec3; 3]]) -> (Vec<Node>, Vec<u32>) {
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    let mut nodes = Vec::new();
    if !corners.is_empty() {
        let boxes: Vec<Bounds> = corners.iter().map(|c| Bounds::of(c)).collect();
        let mut builder = Builder { boxes, order: &mut order, nodes: &mut nodes };
        builder.split(0, corners.len(), 0);
    }
    (nodes, order)
}

#[derive(Clone, Copy)]
struct Bounds {
    lo: Vec3,
    hi: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    fn of(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, p| Self { lo: b.lo.min(*p), hi: b.hi.max(*p) })
    }

    fn with(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    fn center(&self) -> Vec3 {
        0.5 * (self.lo + self.hi)
    }

    /// Returns half the surface area; 0 if empty.
    fn area(&self) -> f32 {
        let d = (self.hi - self.lo).max(Vec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

struct Builder<'a> {
    boxes: Vec<Bounds>,
    order: &'a mut Vec<u32>,
    nodes: &'a mut Vec<Node>,
}

impl Builder<'_> {
    fn split(&mut self, from: usize, to: usize, depth: usize) {
        let items = &self.order[from..to];
        let bounds = items.iter().fold(Bounds::EMPTY, |b, &i| b.with(self.boxes[i as usize]));
        let index = self.nodes.len();
        let count = to - from;
        self.nodes.push(Node { lo: bounds.lo, hi: bounds.hi, first: from as u32, count: count as u32 });
        if count <= LEAF {
            return;
        }
        let split_index = from + self.partition(from, to, depth);
        self.split(from, split_index, depth + 1);
        let right = self.nodes.len() as u32;
        self.split(split_index, to, depth + 1);
        self.nodes[index].first = right;
        self.nodes[index].count = 0;
    }

    /// Reorders `from..to` into two nonempty parts and returns the size of the first.
    fn partition(&mut self, from: usize, to: usize, depth: usize) -> usize {
        let Self { boxes, order, .. } = self;
        let items = &mut order[from..to];
        let centers = items.iter().fold(Bounds::EMPTY, |b, &i| {
            let c = boxes[i as usize].center();
            b.with(Bounds { lo: c, hi: c })
        });
        // Median splits from here on bound the depth.
        let best = if depth < DEPTH / 2 { best_bin(items, boxes, centers) } else { None };
        if let Some((axis, bin)) = best {
            let mut first = 0;
            for i in 0..items.len() {
                if bin_of(boxes[items[i] as usize].center(), centers, axis) <= bin {
                    items.swap(first, i);
                    first += 1;
                }
            }
            if first > 0 && first < items.len() {
                return first;
            }
        }
        let axis = (centers.hi - centers.lo).max_position();
        let half = items.len() / 2;
        let key = |i: &u32| boxes[*i as usize].center()[axis];
        items.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)));
        half
    }
}

/// Returns the axis and the last bin of the left part of the cheapest split, or `None` if all centers coincide.
fn best_bin(items: &[u32], boxes: &[Bounds], centers: Bounds) -> Option<(usize, usize)> {
    let mut best = (f32::INFINITY, None);
    for axis in 0..3 {
        if centers.hi[axis] <= centers.lo[axis] {
            continue;
        }
        let mut bins = [(Bounds::EMPTY, 0u32); BINS];
        for &i in items {
            let bounds = boxes[i as usize];
            let bin = &mut bins[bin_of(bounds.center(), centers, axis)];
            *bin = (bin.0.with(bounds), bin.1 + 1);
        }
        // Sum the costs right of each bin from the right, then the costs left of it from the left.
        let mut right = [0.0; BINS];
        let (mut sum, mut count) = (Bounds::EMPTY, 0);
        for b in (1..BINS).rev() {
            (sum, count) = (sum.with(bins[b].0), count + bins[b].1);
            right[b - 1] = sum.area() * count as f32;
        }
        (sum, count) = (Bounds::EMPTY, 0);
        for b in 0..BINS - 1 {
            (sum, count) = (sum.with(bins[b].0), count + bins[b].1);
            let cost = sum.area() * count as f32 + right[b];
            if count > 0 && (count as usize) < items.len() && cost < best.0 {
                best = (cost, Some((axis, b)));
            }
        }
    }
    best.1
}

fn bin_of(center: Vec3, centers: Bounds, axis: usize) -> usize {
    let t = (center[axis] - centers.lo[axis]) / (centers.hi[axis] - centers.lo[axis]);
    ((t * BINS as f32) as usize).min(BINS - 1)
}
