//! Cuts along lines and around outlines.

use super::{StrokeSample, solve::unit};
use crate::SdfGrid;
use glam::Vec3;

/// Depth below the skin to which a shell reaches, meters.
pub(super) const SKIN: f32 = 0.02;
/// Distance of the eye from a cut without a camera, meters.
const FAR: f32 = 10.0;
/// Parts of a path in which hair hides other hair.
const BINS: usize = 64;
/// Thickness of the hair on the near side, meters.
const CURTAIN: f32 = 0.06;

/// A straight cut between two rays from one eye.
#[derive(Clone, Copy)]
pub(super) struct CutLine {
    eye: Vec3,
    from: Vec3,
    to: Vec3,
}

impl CutLine {
    /// Creates the cut between the sights of two samples; without a camera, between points seen from far along z.
    pub fn new(first: &StrokeSample, last: &StrokeSample) -> Self {
        match first.direction == Vec3::ZERO {
            true => {
                let eye = 0.5 * (first.origin + last.origin) + Vec3::Z * FAR;
                Self { eye, from: first.origin - eye, to: last.origin - eye }
            }
            false => Self { eye: last.origin, from: first.direction, to: last.direction },
        }
    }

    fn mirrored(&self, mirror_x: f32) -> Self {
        let flip = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let eye = Vec3::new(2.0 * mirror_x - self.eye.x, self.eye.y, self.eye.z);
        Self { eye, from: flip(self.from), to: flip(self.to) }
    }

    /// Returns the places where a polyline crosses the cut, from its first point.
    fn crossings(self, points: &[Vec3]) -> impl Iterator<Item = Crossing> {
        let normal = self.from.cross(self.to);
        let crossing = move |(i, edge): (usize, &[Vec3])| {
            let [a, b] = [edge[0], edge[1]].map(|p| (p - self.eye).dot(normal));
            let t = a / (a - b);
            let ray = edge[0].lerp(edge[1], t) - self.eye;
            let (left, right) = (self.from.cross(ray).dot(normal), ray.cross(self.to).dot(normal));
            let crosses = a * b <= 0.0 && a != b && left >= 0.0 && right >= 0.0 && left + right > 0.0;
            crosses.then(|| Crossing { at: i as f32 + t, along: left / (left + right), depth: ray.length() })
        };
        points.windows(2).enumerate().filter_map(crossing)
    }
}

/// A cut along lines from one eye: one line, or the outline of a region.
#[derive(Clone)]
pub(super) struct CutPath {
    lines: Vec<CutLine>,
    is_closed: bool,
}

impl CutPath {
    /// Returns the straight cut between two samples.
    pub fn line(first: &StrokeSample, last: &StrokeSample) -> Self {
        Self { lines: vec![CutLine::new(first, last)], is_closed: false }
    }

    /// Returns the cut around the region within `samples`; `None` for fewer than three.
    pub fn outline(samples: &[StrokeSample]) -> Option<Self> {
        let next = samples.iter().cycle().skip(1);
        let lines: Vec<_> = samples.iter().zip(next).map(|(a, b)| CutLine::new(a, b)).collect();
        (lines.len() > 2).then_some(Self { lines, is_closed: true })
    }

    pub fn mirrored(&self, mirror_x: f32) -> Self {
        Self { lines: self.lines.iter().map(|line| line.mirrored(mirror_x)).collect(), ..self.clone() }
    }

    /// Whether `p` is within the outline, as seen from the eye.
    fn holds(&self, p: Vec3) -> bool {
        let Some(first) = self.lines.first().filter(|_| self.is_closed) else { return false };
        let forward = unit(self.lines.iter().map(|line| unit(line.from, Vec3::ZERO)).sum(), Vec3::NEG_Z);
        let right = unit(forward.cross(Vec3::Y), Vec3::X);
        let up = right.cross(forward);
        let flat = |v: Vec3| {
            let depth = v.dot(forward).max(1e-6);
            [v.dot(right) / depth, v.dot(up) / depth]
        };
        let [x, y] = flat(p - first.eye);
        let mut inside = false;
        for line in &self.lines {
            let [[ax, ay], [bx, by]] = [line.from, line.to].map(flat);
            inside ^= (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax);
        }
        inside
    }

    /// Returns the places where a polyline crosses the cut, in order from its first point; none if that is within the
    /// outline.
    pub fn crossings(&self, points: &[Vec3]) -> Vec<Crossing> {
        let count = self.lines.len() as f32;
        let of = |(k, line): (usize, &CutLine)| {
            let along = move |crossing: Crossing| (k as f32 + crossing.along) / count;
            line.crossings(points).map(move |it| Crossing { along: along(it), ..it }).collect::<Vec<_>>()
        };
        let mut all: Vec<Crossing> = self.lines.iter().enumerate().flat_map(of).collect();
        if !all.is_empty() && self.holds(points[0]) {
            return Vec::new();
        }
        all.sort_by(|a, b| a.at.total_cmp(&b.at));
        all
    }

    /// Returns for each part of the path the depth down to which hair is on the near side: a little more than the
    /// nearest hair, and not far below the skin.
    pub fn front<'a>(
        &self,
        crossings: impl Iterator<Item = &'a Crossing>,
        field: Option<&SdfGrid>,
    ) -> Vec<f32> {
        let mut nearest = vec![f32::MAX; BINS];
        for crossing in crossings {
            let nearest = &mut nearest[crossing.bin()];
            *nearest = nearest.min(crossing.depth);
        }
        let depth = |i: usize| {
            let around = i.saturating_sub(1)..=(i + 1).min(BINS - 1);
            let hair = around.map(|i| nearest[i]).fold(f32::MAX, f32::min) + CURTAIN;
            let at = (i as f32 + 0.5) / BINS as f32 * self.lines.len() as f32;
            let line = self.lines[at as usize];
            let direction = unit(line.from.lerp(line.to, at.fract()), Vec3::NEG_Z);
            let skin = field.and_then(|field| field.trace(line.eye, direction, 0.0));
            skin.map_or(hair, |skin| hair.min(skin + SKIN))
        };
        (0..BINS).map(depth).collect()
    }
}

/// A place where a strand crosses a cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Segments from the root.
    pub at: f32,
    /// Share of the path.
    along: f32,
    /// Distance from the eye, meters.
    pub depth: f32,
}

impl Crossing {
    /// Returns the part of the path.
    pub fn bin(&self) -> usize {
        ((self.along * BINS as f32) as usize).min(BINS - 1)
    }
}
