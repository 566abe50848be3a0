//! Guides prepared for growth: smoothed, with frames and a triangulation of their roots.

use super::cells::Cells;
use super::triangles::{delaunay, weights};
use crate::{
    curve::resample_chords,
    scalp::{Scalp, stereographic},
    styles::StyledGuides,
};
use glam::{Vec2, Vec3};

/// Samples per smoothed guide.
const SAMPLES: usize = 96;

/// Guides of a strand, by descending weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GuideWeights {
    pub(crate) guides: [u32; 3],
    pub(crate) weights: [f32; 3],
}

pub(crate) struct Scaffold<'a> {
    styled: &'a StyledGuides,
    /// Smoothed guides, sampled at equal distances.
    points: Vec<Vec3>,
    /// Two directions across the guide at each sample, parallel transported along it.
    across: Vec<[Vec3; 2]>,
    flat: Vec<Vec2>,
    cells: Cells,
    triangles: Vec<[u32; 3]>,
    /// Triangles that touch each grid square of the plane.
    buckets: Vec<Vec<u32>>,
    skull: Vec3,
}

/// Grid squares along each axis of the plane, which spans -BOUND..BOUND.
const SQUARES: usize = 40;
const BOUND: f32 = 2.2;

fn square(v: f32) -> usize {
    (((v + BOUND) / (2.0 * BOUND) * SQUARES as f32).max(0.0) as usize).min(SQUARES - 1)
}

impl<'a> Scaffold<'a> {
    pub(crate) fn new(styled: &'a StyledGuides, scalp: &dyn Scalp) -> Self {
        let skull = scalp.landmarks().skull;
        let mut points = Vec::new();
        let mut across = Vec::new();
        let mut flat = Vec::new();
        for guide in styled.guides.iter() {
            let smooth = resample_chords(&smooth(guide), SAMPLES);
            across.extend(frames(&smooth));
            points.extend_from_slice(&smooth);
            flat.push(stereographic(guide.first().copied().unwrap_or_default() - skull));
        }
        let mut scaffold = Self {
            styled,
            points,
            across,
            cells: Cells::new(flat.clone()),
            flat,
            triangles: Vec::new(),
            buckets: vec![Vec::new(); SQUARES * SQUARES],
            skull,
        };
        scaffold.triangles = delaunay(&scaffold.flat);
        let spacing = scaffold.spacing();
        let kept = |t: &[u32; 3]| scaffold.keeps(*t, spacing, scalp);
        let kept: Vec<[u32; 3]> = scaffold.triangles.iter().copied().filter(kept).collect();
        scaffold.triangles = kept;
        for (i, t) in scaffold.triangles.iter().enumerate() {
            let corners = t.map(|g| scaffold.flat[g as usize]);
            let lo = corners[0].min(corners[1]).min(corners[2]);
            let hi = corners[0].max(corners[1]).max(corners[2]);
            for y in square(lo.y)..=square(hi.y) {
                for x in square(lo.x)..=square(hi.x) {
                    scaffold.buckets[y * SQUARES + x].push(i as u32);
                }
            }
        }
        scaffold
    }

    /// Returns the triangles between guides whose hair runs together.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub(crate) fn root(&self, guide: usize) -> Vec3 {
        self.points[guide * SAMPLES]
    }

    /// Returns the typical distance between neighboring roots, meters: the median edge length of the triangles.
    fn spacing(&self) -> f32 {
        let edge = |a: u32, b: u32| self.root(a as usize).distance(self.root(b as usize));
        let mut edges: Vec<f32> =
            self.triangles.iter().flat_map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]).collect();
        edges.sort_by(f32::total_cmp);
        edges.get(edges.len() / 2).copied().unwrap_or(0.02)
    }

    /// Returns whether hair may be blended over the triangle: no edge is too long or crosses the parting, the middle
    /// lies on the scalp, and the guides have similar directions.
    fn keeps(&self, t: [u32; 3], spacing: f32, scalp: &dyn Scalp) -> bool {
        let roots = t.map(|g| self.root(g as usize));
        let directions = t.map(|g| {
            (self.points[g as usize * SAMPLES + SAMPLES / 4] - self.root(g as usize)).normalize_or_zero()
        });
        let center = scalp.point((roots[0] + roots[1] + roots[2]) / 3.0 - self.skull);
        if self.styled.hairline.inside(center) < -0.004 {
            return false;
        }
        (0..3).all(|k| {
            let (a, b) = (roots[k], roots[(k + 1) % 3]);
            a.distance(b) < 2.6 * spacing
                && directions[k].dot(directions[(k + 1) % 3]) > -0.1
                && !self.crosses(a, b)
        })
    }

    /// Returns whether the parting runs between `a` and `b`.
    fn crosses(&self, a: Vec3, b: Vec3) -> bool {
        self.styled.parting.as_ref().is_some_and(|parting| parting.separates(a, b))
    }

    /// Returns the guides of a strand rooted at `root`: the corners of its triangle, or of the nearest one.
    pub(crate) fn blend(&self, root: Vec3) -> Option<GuideWeights> {
        let p = stereographic(root - self.skull);
        let weigh = |t: &[u32; 3]| weights(t.map(|g| self.flat[g as usize]), p);
        for &i in &self.buckets[square(p.y) * SQUARES + square(p.x)] {
            let t = &self.triangles[i as usize];
            let (w, d) = weigh(t);
            if d == 0.0 {
                return Some(GuideWeights::new(*t, w));
            }
        }
        let mut best = (f32::INFINITY, None);
        for t in &self.triangles {
            let (w, d) = weigh(t);
            if d < best.0 && !t.iter().any(|&g| self.crosses(root, self.root(g as usize))) {
                best = (d, Some(GuideWeights::new(*t, w)));
            }
        }
        best.1.or_else(|| self.single(root))
    }

    /// Returns the guide of a strand rooted at `root`: the nearest on its side of the parting.
    pub(crate) fn single(&self, root: Vec3) -> Option<GuideWeights> {
        let p = stereographic(root - self.skull);
        let cost = |i: usize, d: f32| if self.crosses(root, self.root(i)) { d + 1.0 } else { d };
        let guide = self.cells.nearest(p, 1.0, cost)? as u32;
        Some(GuideWeights { guides: [guide; 3], weights: [1.0, 0.0, 0.0] })
    }

    fn locate(t: f32) -> (usize, f32) {
        let x = t.clamp(0.0, 1.0) * (SAMPLES - 1) as f32;
        let i = (x as usize).min(SAMPLES - 2);
        (i, x - i as f32)
    }

    /// Samples a guide at the fraction `t` of its length.
    pub(crate) fn sample(&self, guide: u32, t: f32) -> Vec3 {
        let (i, f) = Self::locate(t);
        let at = guide as usize * SAMPLES + i;
        self.points[at].lerp(self.points[at + 1], f)
    }

    /// Returns the two directions across a guide at the fraction `t` of its length.
    pub(crate) fn across(&self, guide: u32, t: f32) -> [Vec3; 2] {
        let (i, f) = Self::locate(t);
        let at = guide as usize * SAMPLES + i;
        let [a, b] = [self.across[at], self.across[at + 1]];
        [a[0].lerp(b[0], f), a[1].lerp(b[1], f)]
    }

    /// Returns the blended point at the fraction `t` of the guides' lengths.
    pub(crate) fn blended(&self, bound: &GuideWeights, t: f32) -> Vec3 {
        (0..3).map(|k| self.sample(bound.guides[k], t) * bound.weights[k]).sum()
    }
}

impl GuideWeights {
    fn new(guides: [u32; 3], weights: [f32; 3]) -> Self {
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| f32::total_cmp(&weights[b], &weights[a]));
        let sum: f32 = weights.iter().sum();
        Self { guides: order.map(|k| guides[k]), weights: order.map(|k| weights[k] / sum) }
    }
}

/// Returns a Catmull-Rom curve through the vertices, four points per edge.
fn smooth(line: &[Vec3]) -> Vec<Vec3> {
    let Some(last) = line.len().checked_sub(1) else { return vec![Vec3::ZERO; 2] };
    let mut out = Vec::with_capacity(4 * line.len());
    for i in 0..last {
        let (a, b) = (line[i], line[i + 1]);
        let before = if i > 0 { line[i - 1] } else { a + (a - b) };
        let after = if i + 2 <= last { line[i + 2] } else { b + (b - a) };
        for k in 0..4 {
            let t = k as f32 * 0.25;
            let (m0, m1) = ((b - before) * 0.5, (after - a) * 0.5);
            let (t2, t3) = (t * t, t * t * t);
            out.push(
                a * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + m0 * (t3 - 2.0 * t2 + t)
                    + b * (3.0 * t2 - 2.0 * t3)
                    + m1 * (t3 - t2),
            );
        }
    }
    out.push(line[last]);
    out
}

/// Returns two directions across the line at each of its points, parallel transported by the smallest rotation between
/// edges.
pub(crate) fn frames(line: &[Vec3]) -> Vec<[Vec3; 2]> {
    frames_from(line, Vec3::ZERO)
}

/// [`frames`] with the second direction at the root as close to `outward` as possible.
pub(crate) fn frames_from(line: &[Vec3], outward: Vec3) -> Vec<[Vec3; 2]> {
    let mut out = Vec::with_capacity(line.len());
    let mut normal = Vec3::ZERO;
    let mut last = Vec3::ZERO;
    for i in 0..line.len() {
        let edge = line[(i + 1).min(line.len() - 1)]
            - line[if i + 1 < line.len() { i } else { i.saturating_sub(1) }];
        let tangent = edge.normalize_or(if i == 0 { Vec3::Y } else { last });
        if i == 0 {
            normal = outward.cross(tangent).try_normalize().unwrap_or(tangent.any_orthonormal_vector());
        } else {
            normal = glam::Quat::from_rotation_arc(last, tangent) * normal;
            normal = (normal - tangent * normal.dot(tangent)).normalize_or(tangent.any_orthonormal_vector());
        }
        last = tangent;
        out.push([normal, tangent.cross(normal)]);
    }
    out
}
