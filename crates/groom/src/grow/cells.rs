//! Nearest-point search in the plane with a grid of cells.

use glam::Vec2;

/// Points sorted into square cells.
pub(crate) struct Cells {
    lo: Vec2,
    size: f32,
    wide: i32,
    high: i32,
    starts: Vec<u32>,
    items: Vec<u32>,
    points: Vec<Vec2>,
}

impl Cells {
    /// Sorts `points` into cells, about two per cell.
    pub(crate) fn new(points: Vec<Vec2>) -> Self {
        let first = points.first().copied().unwrap_or_default();
        let (lo, hi) = points.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let span = (hi - lo).max(Vec2::splat(1e-6));
        let size =
            (span.x * span.y * 2.0 / points.len().max(1) as f32).sqrt().max(span.max_element() / 1000.0);
        let (wide, high) = ((span.x / size) as i32 + 1, (span.y / size) as i32 + 1);
        let mut cells = Self { lo, size, wide, high, starts: Vec::new(), items: Vec::new(), points };
        let mut counts = vec![0u32; (wide * high) as usize + 1];
        let homes: Vec<usize> = cells.points.iter().map(|p| cells.home(*p)).collect();
        for &home in &homes {
            counts[home + 1] += 1;
        }
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut next = counts.clone();
        cells.items = vec![0; homes.len()];
        for (i, &home) in homes.iter().enumerate() {
            cells.items[next[home] as usize] = i as u32;
            next[home] += 1;
        }
        cells.starts = counts;
        cells
    }

    fn cell(&self, p: Vec2) -> (i32, i32) {
        let q = (p - self.lo) / self.size;
        ((q.x as i32).clamp(0, self.wide - 1), (q.y as i32).clamp(0, self.high - 1))
    }

    fn home(&self, p: Vec2) -> usize {
        let (x, y) = self.cell(p);
        (y * self.wide + x) as usize
    }

    /// Returns the point with the smallest `cost`, which must be at least `floor` times the squared distance.
    pub(crate) fn nearest(&self, p: Vec2, floor: f32, cost: impl Fn(usize, f32) -> f32) -> Option<usize> {
        let (cx, cy) = self.cell(p);
        let mut best = (f32::INFINITY, None);
        for ring in 0..self.wide.max(self.high) {
            // All points in this ring and beyond are at least this far away.
            let far = ((ring - 1).max(0) as f32 * self.size).powi(2) * floor;
            if far > best.0 {
                break;
            }
            for y in cy - ring..=cy + ring {
                let edge = y == cy - ring || y == cy + ring;
                let step = if edge || ring == 0 { 1 } else { 2 * ring };
                let mut x = cx - ring;
                while x <= cx + ring {
                    if x >= 0 && y >= 0 && x < self.wide && y < self.high {
                        let home = (y * self.wide + x) as usize;
                        for &i in &self.items[self.starts[home] as usize..self.starts[home + 1] as usize] {
                            let c = cost(i as usize, self.points[i as usize].distance_squared(p));
                            if c < best.0 {
                                best = (c, Some(i as usize));
                            }
                        }
                    }
                    x += step;
                }
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Rng;

    #[test]
    fn nearest_point_matches_brute_force() {
        let mut rng = Rng::new(1, 2);
        let points: Vec<Vec2> = (0..300).map(|_| Vec2::new(rng.unit(), rng.unit() * 0.5)).collect();
        let cells = Cells::new(points.clone());
        for _ in 0..300 {
            let p = Vec2::new(rng.range(-0.2, 1.2), rng.range(-0.2, 0.7));
            let brute = (0..300).min_by(|&a, &b| points[a].distance(p).total_cmp(&points[b].distance(p)));
            assert_eq!(cells.nearest(p, 1.0, |_, d| d), brute);
        }
        assert_eq!(Cells::new(Vec::new()).nearest(Vec2::ZERO, 1.0, |_, d| d), None);
    }
}
