//! What wider strands cover: more than as many thin ones of the same area, where they reach over gaps
//! and outlines. The factors on their widths that take it back are measured on the CPU at load.

use super::curve::{CurveTable, resample};
use crate::{groom::BoundStrands, strands::Strand};
use glam::{Vec2, Vec3};

/// Cells along each edge of a view.
const GRID: usize = 192;
/// At most so many strands stand for all of them.
const MOST: usize = 6000;
/// The narrowest that strands are made.
const NARROWEST: f32 = 0.5;

/// The factors of a groom on the widths of fewer strands.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverTable {
    /// Share of the strands and the factor that belongs to it, shares falling from 1.
    points: Vec<(f32, f32)>,
}

/// A strand that is splatted.
struct Line {
    points: Vec<Vec3>,
    /// At the root and beyond, metres: a radius for every point.
    radii: Vec<f32>,
}

/// The share of light that passes each cell of a view.
struct View {
    right: Vec3,
    up: Vec3,
    corner: Vec2,
    cell: f32,
    passes: Vec<f32>,
}

impl CoverTable {
    /// Nothing known: as wide as their area wants.
    pub fn none() -> Self {
        Self { points: vec![(1.0, 1.0)] }
    }

    /// For `strands` in the order of [`arrange`](super::arrange) with the radii of `infos`, inside the sphere
    /// of `radius` metres around `middle`. `levels` has shares of strands, falling, with the widening
    /// and the segments that belong to each.
    pub fn new(
        strands: &BoundStrands,
        infos: &[Strand],
        (middle, radius): (Vec3, f32),
        levels: &[(f32, f32, f32)],
    ) -> Self {
        let mut table = Self::none();
        let base = infos.len().min(MOST);
        if base == 0 || radius <= 0.0 {
            return table;
        }
        let share = base as f32 / infos.len() as f32;
        let lines: Vec<Line> = (0..base).map(|i| line(strands, infos, i)).collect();
        let mut views = views(middle, radius);
        // Where the base is not all strands it stands for them, a little wider.
        let full = covered(&mut views, &lines, share.recip(), None);
        for (fraction, widening, segments) in levels {
            let count = (fraction * infos.len() as f32).ceil() as usize;
            if count >= base {
                continue;
            }
            let mut cover = |factor: f32| {
                covered(&mut views, &lines[..count.max(1)], widening * factor, Some(*segments))
            };
            // Two steps of the secant method: coverage grows smoothly with the width.
            let (mut a, mut b) = (1.0, 0.85);
            let (mut at_a, mut at_b) = (cover(a), cover(b));
            for _ in 0..2 {
                let slope = (at_a - at_b) / (a - b);
                if slope.abs() < 1e-9 {
                    break;
                }
                let next = (b + (full - at_b) / slope).clamp(NARROWEST, 1.5);
                (a, at_a, b) = (b, at_b, next);
                if a == b {
                    break;
                }
                at_b = cover(b);
            }
            table.points.push((*fraction, b));
        }
        table
    }

    /// The factor where the share `fraction` of the strands is drawn.
    pub fn factor(&self, fraction: f32) -> f32 {
        let Some(k) = self.points.iter().position(|(at, _)| *at <= fraction) else {
            return self.points.last().map_or(1.0, |(_, factor)| *factor);
        };
        if k == 0 {
            return self.points[0].1;
        }
        let ((many, a), (few, b)) = (self.points[k - 1], self.points[k]);
        let t = (many / fraction).ln() / (many / few).ln();
        a + (b - a) * t
    }
}

fn line(strands: &BoundStrands, infos: &[Strand], i: usize) -> Line {
    let n = strands.vertex_count as usize;
    let rest = strands.rest[i * n..(i + 1) * n].iter();
    let (points, radii) = rest.map(|rest| rest.unpack(&strands.bindings[i])).unzip::<_, _, Vec<_>, Vec<_>>();
    Line { points, radii: radii.into_iter().map(|r: f32| r * infos[i].radius).collect() }
}

/// From before, from a side, and between them from above.
fn views(middle: Vec3, radius: f32) -> [View; 3] {
    [Vec3::Z, Vec3::X, Vec3::new(-1.0, 0.6, -1.0)].map(|back| {
        let back = back.normalize();
        let right = Vec3::Y.cross(back).normalize();
        let up = back.cross(right);
        let middle = Vec2::new(middle.dot(right), middle.dot(up));
        let cell = 2.1 * radius / GRID as f32;
        View { right, up, corner: middle - 1.05 * radius, cell, passes: vec![1.0; GRID * GRID] }
    })
}

/// The mean share of the views that `lines` cover, each `widening` times as wide as it is, and drawn with
/// so many segments.
fn covered(views: &mut [View], lines: &[Line], widening: f32, segments: Option<f32>) -> f32 {
    let mut sum = 0.0;
    for view in views.iter_mut() {
        view.passes.fill(1.0);
        for line in lines {
            match segments {
                None => view.splat(&line.points, &line.radii, widening),
                Some(s) => view.splat(&resample(&line.points, s), &line.radii, widening),
            }
        }
        sum += view.passes.iter().map(|passes| 1.0 - passes).sum::<f32>() / view.passes.len() as f32;
    }
    sum / views.len() as f32
}

impl View {
    fn splat(&mut self, points: &[Vec3], radii: &[f32], widening: f32) {
        let scale = self.cell.recip();
        let at = |p: Vec3| (Vec2::new(p.dot(self.right), p.dot(self.up)) - self.corner) * scale;
        let last = (points.len() - 1) as f32;
        for k in 0..points.len() - 1 {
            let (a, b) = (at(points[k]), at(points[k + 1]));
            let way = b - a;
            let length = way.length();
            if length < 1e-6 {
                continue;
            }
            let across = way.perp() / length;
            let steps = length.ceil();
            let along = (k as f32 + 0.5) / last * (radii.len() - 1) as f32;
            let width = 2.0 * radii[along as usize] * widening * scale;
            let lanes = width.ceil().max(1.0);
            // The share of a cell that a patch of the strip covers.
            let patch = 1.0 - (length / steps * (width / lanes)).min(1.0);
            for i in 0..steps as u32 {
                let middle = a + way * ((i as f32 + 0.5) / steps);
                for lane in 0..lanes as u32 {
                    let p = middle + across * ((lane as f32 + 0.5) / lanes - 0.5) * width;
                    let (x, y) = (p.x as usize, p.y as usize);
                    if p.x >= 0.0 && p.y >= 0.0 && x < GRID && y < GRID {
                        self.passes[y * GRID + x] *= patch;
                    }
                }
            }
        }
    }
}

/// The levels that [`CoverTable::new`] looks at: half octaves down to `least`.
pub fn levels(
    least: f32,
    curve: &CurveTable,
    widening: impl Fn(f32) -> f32,
    segments: impl Fn(f32) -> f32,
) -> Vec<(f32, f32, f32)> {
    let mut levels = Vec::new();
    let mut fraction = 0.5f32;
    while fraction >= least {
        let segments = segments(fraction);
        levels.push((fraction, widening(fraction) / curve.length(segments), segments));
        fraction *= std::f32::consts::FRAC_1_SQRT_2;
    }
    levels
}
