//! Visible parts of strands, on the CPU: small depth-ordered images of strips.

use super::curve::resample;
use crate::{groom::BoundStrands, strands::Strand};
use glam::{Vec2, Vec3};

/// Cells along each edge of the finest image.
const FINE: f32 = 256.0;
/// Maximum length of a piece of strand with a single depth, relative to the hair's radius.
const PIECE: f32 = 0.04;
/// Cell size, in fine cells, above which results are averaged over several images offset by half a cell. Otherwise the
/// alignment of coarse cells would affect the result.
const COARSE: f32 = 3.0;
/// Directions to the eyes: front, side, and from behind above the other side.
pub(super) const EYES: [Vec3; 3] = [Vec3::Z, Vec3::X, Vec3::new(-1.0, 0.6, -1.0)];
/// Visible fraction of a vertex for each eye.
pub(super) type Visibility = [f32; EYES.len()];

/// A strand as drawn at a level of detail.
pub(super) struct Strip {
    pub(super) points: Vec<Vec3>,
    /// Radius at each point, meters.
    pub(super) radii: Vec<f32>,
}

impl Strip {
    /// Creates the strip of strand `i`, resampled to `segments` segments if given.
    pub(super) fn new(strands: &BoundStrands, infos: &[Strand], i: usize, segments: Option<f32>) -> Self {
        let n = strands.vertex_count as usize;
        let rest = strands.rest[i * n..(i + 1) * n].iter();
        let (points, radius_factors) =
            rest.map(|rest| rest.unpack(&strands.bindings[i])).unzip::<_, _, Vec<_>, Vec<f32>>();
        let radius = infos[i].radius;
        let Some(segments) = segments.filter(|s| *s < (n - 1) as f32) else {
            return Self {
                points,
                radii: radius_factors.into_iter().map(|factor| factor * radius).collect(),
            };
        };
        let radius_vectors: Vec<Vec3> =
            radius_factors.into_iter().map(|factor| Vec3::splat(factor * radius)).collect();
        let radii = resample(&radius_vectors, segments).into_iter().map(|r| r.x).collect();
        Self { points: resample(&points, segments), radii }
    }

    /// Returns the length, meters.
    pub(super) fn length(&self) -> f32 {
        self.points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }
}

/// Returns the right, up and back axes for a view along `-back`.
pub(super) fn axes(back: Vec3) -> (Vec3, Vec3, Vec3) {
    let back = back.normalize();
    let right = Vec3::Y.cross(back).normalize();
    (right, back.cross(right), back)
}

/// A part of a strip with a single depth.
struct Piece {
    /// Position towards the eye, meters.
    depth: f32,
    a: Vec2,
    b: Vec2,
    width: f32,
    /// Preceding vertex among all strips, and the fractions of the way to the next vertex at which the piece begins and
    /// ends.
    vertex: u32,
    span: [f32; 2],
    /// Index of its segment.
    segment: u32,
}

/// A segment as tiles draw it (`draw/tiles/row.wesl`).
struct Segment {
    a: Vec2,
    b: Vec2,
    /// Unit vectors across the strip at both ends.
    sides: [Vec2; 2],
    width: f32,
}

/// Minimum agreement of the directions of two segments that share an end line. (`row::meeting` requires 0.5 of a
/// direction whose length is 0.7 to 1.)
const ALIKE: f32 = 0.6;

impl Segment {
    /// Returns the length over which the segment covers its full width, for cells of `cell` meters and with the width
    /// scaled by `widening`.
    ///
    /// A pixel belongs to the segment on whose side of the lines across its ends the pixel's center lies. Where a
    /// strand turns within a pixel, these lines cross beside it, and the covered width is zero beyond the crossing, not
    /// negative.
    fn drawn(&self, widening: f32, cell: f32) -> f32 {
        let delta = self.b - self.a;
        let length = delta.length();
        let along = delta.normalize_or_zero();
        // Same as in `draw/tiles/row.wesl`.
        let slope = |side: Vec2| {
            let alignment = side.perp_dot(along).abs();
            if alignment > ALIKE { side.dot(along) / side.perp_dot(along) } else { 0.0 }
        };
        let [a, b] = self.sides.map(slope);
        let extent = (a - b).abs() * 0.5 * (widening * self.width + cell * (along.x.abs() + along.y.abs()));
        if extent <= length { length } else { 0.25 * (length + extent).powi(2) / extent }
    }
}

/// Strips as seen by each eye.
pub(super) struct Pictures {
    /// Pieces and segments for each eye.
    pieces: Vec<(Vec<Piece>, Vec<Segment>)>,
    radius: f32,
    vertices: usize,
    passes: Vec<f32>,
    /// [`Segment::drawn`] of each segment.
    drawn: Vec<f32>,
}

impl Pictures {
    /// Projects `strips`, which lie in the sphere of `radius` meters around `center`.
    pub(super) fn new(strips: &[Strip], (center, radius): (Vec3, f32)) -> Self {
        let vertices = strips.iter().map(|strip| strip.points.len()).sum();
        let pieces = EYES.map(|back| pieces(strips, center, back, PIECE * radius)).into();
        Self { pieces, radius, vertices, passes: Vec::new(), drawn: Vec::new() }
    }

    /// Returns the edge of the finest cells, meters.
    pub(super) fn finest(&self) -> f32 {
        2.1 * self.radius / FINE
    }

    /// Sorts pieces from near to far for each eye.
    pub(super) fn sort(&mut self) {
        for (pieces, _) in &mut self.pieces {
            pieces.sort_unstable_by(|a, b| b.depth.total_cmp(&a.depth));
        }
    }

    /// Returns the mean area that the strips cover in images with cells of `cell` meters, m². Widths are scaled by
    /// `widening`. Not generic, so that it is compiled and optimized with this library.
    pub(super) fn area(&mut self, widening: f32, cell: f32) -> f32 {
        self.covered(widening, cell, |_, _, _| ())
    }

    /// [`area`](Self::area) with a callback: `visit` receives visible fractions of vertices, which are valid once the
    /// pieces are sorted.
    pub(super) fn covered(
        &mut self,
        widening: f32,
        cell: f32,
        mut visit: impl FnMut(usize, u32, f32),
    ) -> f32 {
        let phases: &[[f32; 2]] = if cell > COARSE * self.finest() {
            &[[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]]
        } else {
            &[[0.0, 0.0]]
        };
        let half = (1.05 * self.radius / cell).ceil() + 1.0;
        let wide = 2 * half as usize + 1;
        let scale = cell.recip();
        let mut sum = 0.0;
        for (eye, (pieces, segments)) in self.pieces.iter().enumerate() {
            self.drawn.clear();
            self.drawn.extend(segments.iter().map(|segment| segment.drawn(widening, cell)));
            let mut visit_vertex = |vertex, amount| visit(eye, vertex, amount);
            for phase in phases {
                self.passes.clear();
                self.passes.resize(wide * wide, 1.0);
                for piece in pieces {
                    let strip = [self.drawn[piece.segment as usize], widening * piece.width];
                    let shift = half + Vec2::from(*phase);
                    splat(piece, strip, scale, shift, wide, &mut self.passes, &mut visit_vertex);
                }
                sum += self.passes.iter().map(|passes| 1.0 - passes).sum::<f32>();
            }
        }
        sum * cell * cell / (self.pieces.len() * phases.len()) as f32
    }

    /// Returns the visible fraction of each vertex. A point between two vertices contributes to both by proximity.
    pub(super) fn visibility(&mut self, widening: f32, cell: f32) -> Vec<Visibility> {
        self.sort();
        let mut weights = vec![Visibility::default(); self.vertices];
        self.covered(widening, cell, |eye, vertex, amount| weights[vertex as usize][eye] += amount);
        weights
    }
}

fn pieces(strips: &[Strip], center: Vec3, back: Vec3, longest: f32) -> (Vec<Piece>, Vec<Segment>) {
    let (right, up, back) = axes(back);
    let flat = |p: Vec3| Vec2::new(p.dot(right), p.dot(up));
    let (mut pieces, mut segments) = (Vec::new(), Vec::new());
    let mut vertex = 0;
    for strip in strips {
        let mut side = None;
        let edges = strip.points.windows(2).zip(strip.radii.windows(2));
        for (i, (points, radii)) in edges.enumerate() {
            // As in `interpolate` and `draw::alpha`: a tangent is the mean of the directions of the two edges.
            let edge = |i: usize| (strip.points[i + 1] - strip.points[i]).normalize_or_zero();
            let across = |tangent: Vec3| flat(tangent.cross(back).normalize_or_zero());
            let before = side.unwrap_or_else(|| across(edge(i)));
            let next = if i + 2 < strip.points.len() { edge(i) + edge(i + 1) } else { edge(i) };
            let behind = across(next);
            side = Some(behind);
            let [from, to] = [points[0] - center, points[1] - center];
            let parts = (from.distance(to) / longest).ceil().max(1.0);
            for k in 0..parts as u32 {
                let span = [k as f32 / parts, (k + 1) as f32 / parts];
                let [a, b] = span.map(|t| from.lerp(to, t));
                let t = 0.5 * (span[0] + span[1]);
                pieces.push(Piece {
                    depth: 0.5 * (a + b).dot(back),
                    a: flat(a),
                    b: flat(b),
                    width: 2.0 * (radii[0] + (radii[1] - radii[0]) * t),
                    vertex,
                    span,
                    segment: segments.len() as u32,
                });
            }
            let (a, b) = (flat(from), flat(to));
            segments.push(Segment { a, b, sides: [before, behind], width: radii[0] + radii[1] });
            vertex += 1;
        }
        vertex += 1;
    }
    (pieces, segments)
}

/// Draws a piece into an image. `drawn` is the length over which its segment covers its width, meters.
fn splat(
    piece: &Piece,
    [drawn, width]: [f32; 2],
    scale: f32,
    shift: Vec2,
    wide: usize,
    passes: &mut [f32],
    visit: &mut impl FnMut(u32, f32),
) {
    let delta = (piece.b - piece.a) * scale;
    let length = delta.length();
    let steps = length.ceil();
    if length < 1e-6 || steps < 1.0 {
        return;
    }
    let start = piece.a * scale + shift;
    let across = delta.perp() / length;
    let width = width * scale;
    let lanes = width.ceil().max(1.0);
    // Share of a cell that a patch of the strip covers.
    let drawn = drawn * scale * (piece.span[1] - piece.span[0]);
    let coverage = (drawn / steps * (width / lanes)).min(1.0);
    for i in 0..steps as u32 {
        let t = (i as f32 + 0.5) / steps;
        let center = start + delta * t;
        let mut visible = 0.0;
        for lane in 0..lanes as u32 {
            let p = center + across * (((lane as f32 + 0.5) / lanes - 0.5) * width);
            let (x, y) = (p.x as usize, p.y as usize);
            if p.x >= 0.0 && p.y >= 0.0 && x < wide && y < wide {
                let passes = &mut passes[y * wide + x];
                visible += *passes;
                *passes *= 1.0 - coverage;
            }
        }
        let t = piece.span[0] + (piece.span[1] - piece.span[0]) * t;
        visit(piece.vertex, visible * coverage * (1.0 - t));
        visit(piece.vertex + 1, visible * coverage * t);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// `layers` curtains of strands side by side, 1 m × 1 m each, 10 cm apart from the front (+Z) on. Each hides the
    /// fraction `share` of the background.
    pub(in super::super) fn curtains(layers: u32, share: f32) -> Vec<Strip> {
        let line = |i: u32| {
            let x = ((i / layers) as f32 + 0.5) / 200.0 - 0.5;
            let z = 0.1 * (0.5 * (layers - 1) as f32 - (i % layers) as f32);
            let points = [-0.5, 0.0, 0.5].map(|y| Vec3::new(x, y, z)).to_vec();
            Strip { points, radii: vec![0.5 * share / 200.0; 3] }
        };
        (0..200 * layers).map(line).collect()
    }

    #[test]
    fn visibility_falls_by_coverage_per_layer() {
        let strips = curtains(3, 0.4);
        let mut pictures = Pictures::new(&strips, (Vec3::ZERO, 0.8));
        let cell = 0.02;
        let seen = pictures.visibility(1.0, cell);
        let of = |layer: usize| -> f32 {
            let strips = seen.chunks(3).enumerate().filter(|(i, _)| i % 3 == layer);
            strips.flat_map(|(_, seen)| seen).map(|seen| seen[0]).sum()
        };
        for layer in 1..3 {
            let ratio = of(layer) / of(layer - 1);
            // Four strands per cell in random order, each covering a tenth of it.
            assert!((ratio - 0.9f32.powi(4)).abs() < 0.02, "{layer}: {ratio}");
        }
    }

    #[test]
    fn strips_turning_within_a_cell_cover_more() {
        let segment = |sides| Segment { a: Vec2::ZERO, b: Vec2::new(0.3, 0.0), sides, width: 0.1 };
        let straight = segment([Vec2::Y; 2]);
        assert!((straight.drawn(1.0, 1.0) - 0.3).abs() < 1e-6);
        // A turn of 45°: the area beyond the crossing of the end lines counts as zero.
        let turned = segment([Vec2::Y, Vec2::ONE.normalize()]);
        assert!((turned.drawn(1.0, 1.0) - 0.25 * 0.85f32.powi(2) / 0.55).abs() < 1e-6);
        // A half turn in place: the ends do not share a line.
        assert!((segment([Vec2::Y, -Vec2::Y]).drawn(1.0, 1.0) - 0.3).abs() < 1e-6);
        // Fine cells do not show it.
        assert!((segment([Vec2::Y, Vec2::new(0.1, 1.0).normalize()]).drawn(0.1, 1e-3) - 0.3).abs() < 1e-3);
    }
}
