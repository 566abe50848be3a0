//! Counts the strands that rays of light hit, by brute force.

use super::tangle::Tangle;
use tresses::{
    glam::{Vec2, Vec3},
    groom::hash::pcg,
};

/// Reference values at a point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Truth {
    /// Share of the light that hits no fiber.
    pub transmittance: f32,
    /// Mean number of fibers between light and point.
    pub fibers: f32,
}

/// A cylinder, given by its ends: x and y across the light, z along it, growing away from the light.
#[derive(Clone, Copy)]
struct Segment {
    a: Vec3,
    b: Vec3,
    radii: Vec2,
    strand: u32,
}

/// All strands as seen by one light, sorted into cells across its rays.
pub struct Oracle {
    axes: [Vec3; 3],
    low: Vec2,
    wide: usize,
    high: usize,
    cells: Vec<Vec<u32>>,
    segments: Vec<Segment>,
}

/// Edge of a cell, meters.
const CELL: f32 = 0.001;

impl Oracle {
    /// Creates the oracle for light from `direction`.
    pub fn new(tangle: &Tangle, direction: Vec3) -> Self {
        let z = -direction.normalize();
        let (x, y) = z.any_orthonormal_pair();
        let axes = [x, y, z];
        let seen = |p: Vec3| Vec3::new(p.dot(x), p.dot(y), p.dot(z));
        let n = tangle.vertex_count;
        let mut segments = Vec::new();
        for i in 0..tangle.len() * n {
            if i % n + 1 < n {
                segments.push(Segment {
                    a: seen(tangle.positions[i]),
                    b: seen(tangle.positions[i + 1]),
                    radii: Vec2::new(tangle.radii[i], tangle.radii[i + 1]),
                    strand: (i / n) as u32,
                });
            }
        }
        let (low, high) = segments.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(lo, hi), s| {
            let r = Vec2::splat(s.radii.max_element());
            let (a, b) = (s.a.truncate(), s.b.truncate());
            (lo.min(a.min(b) - r), hi.max(a.max(b) + r))
        });
        let size = ((high - low) / CELL).ceil() + 1.0;
        let (wide, high) = (size.x as usize, size.y as usize);
        let mut cells = vec![Vec::new(); wide * high];
        for (i, s) in segments.iter().enumerate() {
            // Every cell near one of the points along the segment.
            let r = s.radii.max_element();
            let steps = (s.a.truncate().distance(s.b.truncate()) / (0.5 * CELL)).ceil().max(1.0);
            for step in 0..=steps as usize {
                let at = s.a.truncate().lerp(s.b.truncate(), step as f32 / steps) - low;
                let reach = Vec2::splat(r + 0.25 * CELL);
                let from = ((at - reach) / CELL).max(Vec2::ZERO).as_uvec2();
                let to = ((at + reach) / CELL).max(Vec2::ZERO).as_uvec2();
                for cy in from.y as usize..=(to.y as usize).min(high - 1) {
                    for cx in from.x as usize..=(to.x as usize).min(wide - 1) {
                        let cell: &mut Vec<u32> = &mut cells[cy * wide + cx];
                        if cell.last() != Some(&(i as u32)) {
                            cell.push(i as u32);
                        }
                    }
                }
            }
        }
        for cell in &mut cells {
            cell.sort_unstable();
            cell.dedup();
        }
        Self { axes, low, wide, high, cells, segments }
    }

    /// Returns the number of strands other than `own` that the ray to a point (across, depth) hits.
    fn count(&self, at: Vec2, depth: f32, own: u32) -> u32 {
        let place = (at - self.low) / CELL;
        if place.x < 0.0 || place.y < 0.0 {
            return 0;
        }
        let (x, y) = (place.x as usize, place.y as usize);
        if x >= self.wide || y >= self.high {
            return 0;
        }
        let meets = |s: &&Segment| {
            let way = s.b.truncate() - s.a.truncate();
            let t = (at - s.a.truncate()).dot(way) / way.length_squared().max(1e-14);
            (0.0..1.0).contains(&t)
                && s.strand != own
                && s.a.z + t * (s.b.z - s.a.z) < depth
                && (s.a.truncate() + t * way).distance(at) < s.radii.x + t * (s.radii.y - s.radii.x)
        };
        self.cells[y * self.wide + x].iter().map(|i| &self.segments[*i as usize]).filter(meets).count() as u32
    }

    /// Returns the reference values at `point` of the strand `own`, over `rays` rays through a disk of `radius` meters.
    pub fn at(&self, point: Vec3, own: u32, radius: f32, rays: u32) -> Truth {
        let [x, y, z] = self.axes.map(|axis| point.dot(axis));
        let mut truth = Truth::default();
        for i in 0..rays {
            // A sunflower pattern, rotated by an angle per point.
            let angle = i as f32 * 2.399_963 + pcg(own ^ x.to_bits()) as f32 * 1e-9;
            let r = radius * ((i as f32 + 0.5) / rays as f32).sqrt();
            let count = self.count(Vec2::new(x, y) + r * Vec2::from_angle(angle), z, own);
            truth.fibers += count as f32 / rays as f32;
            truth.transmittance += if count == 0 { 1.0 / rays as f32 } else { 0.0 };
        }
        truth
    }
}
