//! What the eye sees of strands on the CPU, and how much light gets there: small pictures of strips in the
//! order of their depth, and counts of fibres towards lights.

use super::curve::resample;
use crate::{groom::BoundStrands, strands::Strand};
use glam::{Vec2, Vec3};

/// Cells along each edge of a fine picture.
const FINE: f32 = 256.0;
/// Longer parts of a strand than this share of the hair's radius have no one depth.
const PIECE: f32 = 0.04;
/// From this many fine cells on a picture is made of several, half a cell apart: where its cells happen to
/// lie would show.
const COARSE: f32 = 3.0;
/// Cells along each edge of the grid that fibres are counted in.
const GRID: usize = 96;
/// How near fibres are not counted, metres: what `NEAR` and, for eyes and lights as far apart as these, `SHARED`
/// of `light/transmittance.wesl` come to.
const BIAS: f32 = 0.00275;

/// From before, from a side, and between them from above.
const EYES: [Vec3; 3] = [Vec3::Z, Vec3::X, Vec3::new(-1.0, 0.6, -1.0)];
/// From the upper side before, and from behind: the default lights.
const LIGHTS: [Vec3; 2] = [Vec3::new(-0.42, 0.62, 0.66), Vec3::new(0.85, 0.28, -0.45)];

/// How much of a vertex each eye sees.
pub(super) type Seen = [f32; EYES.len()];

/// A strand as it is drawn.
pub(super) struct Strip {
    points: Vec<Vec3>,
    /// At each point, metres.
    radii: Vec<f32>,
}

impl Strip {
    /// The strand `i`, with so many segments if not all.
    pub(super) fn new(strands: &BoundStrands, infos: &[Strand], i: usize, segments: Option<f32>) -> Self {
        let n = strands.vertex_count as usize;
        let rest = strands.rest[i * n..(i + 1) * n].iter();
        let (points, shares) =
            rest.map(|rest| rest.unpack(&strands.bindings[i])).unzip::<_, _, Vec<_>, Vec<f32>>();
        let radius = infos[i].radius;
        let Some(segments) = segments.filter(|s| *s < (n - 1) as f32) else {
            return Self { points, radii: shares.into_iter().map(|share| share * radius).collect() };
        };
        let shares: Vec<Vec3> = shares.into_iter().map(|share| Vec3::splat(share * radius)).collect();
        let radii = resample(&shares, segments).into_iter().map(|r| r.x).collect();
        Self { points: resample(&points, segments), radii }
    }
}

/// Two axes across a direction.
fn axes(back: Vec3) -> (Vec3, Vec3, Vec3) {
    let back = back.normalize();
    let right = Vec3::Y.cross(back).normalize();
    (right, back.cross(right), back)
}

/// Part of a strip that has one depth.
struct Piece {
    /// Towards the eye, metres.
    depth: f32,
    a: Vec2,
    b: Vec2,
    width: f32,
    /// The vertex before it, among those of all strips, and how far from there to the next it begins and ends.
    vertex: u32,
    span: [f32; 2],
}

/// Strips as each eye sees them.
pub(super) struct Pictures {
    /// Of each eye.
    pieces: Vec<Vec<Piece>>,
    radius: f32,
    vertices: usize,
    passes: Vec<f32>,
}

impl Pictures {
    /// Of `strips` in the sphere of `radius` metres around `middle`.
    pub(super) fn new(strips: &[Strip], (middle, radius): (Vec3, f32)) -> Self {
        let vertices = strips.iter().map(|strip| strip.points.len()).sum();
        let pieces = EYES.map(|back| pieces(strips, middle, back, PIECE * radius)).into();
        Self { pieces, radius, vertices, passes: Vec::new() }
    }

    /// The finest cells that are told apart, metres.
    pub(super) fn finest(&self) -> f32 {
        2.1 * self.radius / FINE
    }

    /// Puts pieces in the order in which the eyes meet them.
    pub(super) fn sort(&mut self) {
        for pieces in &mut self.pieces {
            pieces.sort_unstable_by(|a, b| b.depth.total_cmp(&a.depth));
        }
    }

    /// The mean area that the strips cover in pictures with cells of `cell` metres, m², each strip
    /// `widening` times as wide as it is. `see` is told of each vertex how much of it is seen; that
    /// holds once the pieces are sorted.
    pub(super) fn covered(&mut self, widening: f32, cell: f32, mut see: impl FnMut(usize, u32, f32)) -> f32 {
        let phases: &[[f32; 2]] = if cell > COARSE * self.finest() {
            &[[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]]
        } else {
            &[[0.0, 0.0]]
        };
        let half = (1.05 * self.radius / cell).ceil() + 1.0;
        let wide = 2 * half as usize + 1;
        let scale = cell.recip();
        let mut sum = 0.0;
        for (eye, pieces) in self.pieces.iter().enumerate() {
            let mut see = |vertex, amount| see(eye, vertex, amount);
            for phase in phases {
                self.passes.clear();
                self.passes.resize(wide * wide, 1.0);
                for piece in pieces {
                    splat(
                        piece,
                        widening,
                        scale,
                        half + Vec2::from(*phase),
                        wide,
                        &mut self.passes,
                        &mut see,
                    );
                }
                sum += self.passes.iter().map(|passes| 1.0 - passes).sum::<f32>();
            }
        }
        sum * cell * cell / (self.pieces.len() * phases.len()) as f32
    }

    /// How much is seen of each vertex, of what lies between two the more of the nearer one.
    pub(super) fn seen(&mut self, widening: f32, cell: f32) -> Vec<Seen> {
        self.sort();
        let mut weights = vec![Seen::default(); self.vertices];
        self.covered(widening, cell, |eye, vertex, amount| weights[vertex as usize][eye] += amount);
        weights
    }
}

fn pieces(strips: &[Strip], middle: Vec3, back: Vec3, longest: f32) -> Vec<Piece> {
    let (right, up, back) = axes(back);
    let mut pieces = Vec::new();
    let mut vertex = 0;
    for strip in strips {
        for (points, radii) in strip.points.windows(2).zip(strip.radii.windows(2)) {
            let [from, to] = [points[0] - middle, points[1] - middle];
            let parts = (from.distance(to) / longest).ceil().max(1.0);
            for k in 0..parts as u32 {
                let span = [k as f32 / parts, (k + 1) as f32 / parts];
                let [a, b] = span.map(|t| from.lerp(to, t));
                let t = 0.5 * (span[0] + span[1]);
                pieces.push(Piece {
                    depth: 0.5 * (a + b).dot(back),
                    a: Vec2::new(a.dot(right), a.dot(up)),
                    b: Vec2::new(b.dot(right), b.dot(up)),
                    width: 2.0 * (radii[0] + (radii[1] - radii[0]) * t),
                    vertex,
                    span,
                });
            }
            vertex += 1;
        }
        vertex += 1;
    }
    pieces
}

fn splat(
    piece: &Piece,
    widening: f32,
    scale: f32,
    shift: Vec2,
    wide: usize,
    passes: &mut [f32],
    see: &mut impl FnMut(u32, f32),
) {
    let way = (piece.b - piece.a) * scale;
    let length = way.length();
    let steps = length.ceil();
    if length < 1e-6 || steps < 1.0 {
        return;
    }
    let start = piece.a * scale + shift;
    let across = way.perp() / length;
    let width = piece.width * widening * scale;
    let lanes = width.ceil().max(1.0);
    // The share of a cell that a patch of the strip covers.
    let share = (length / steps * (width / lanes)).min(1.0);
    for i in 0..steps as u32 {
        let t = (i as f32 + 0.5) / steps;
        let middle = start + way * t;
        let mut seen = 0.0;
        for lane in 0..lanes as u32 {
            let p = middle + across * (((lane as f32 + 0.5) / lanes - 0.5) * width);
            let (x, y) = (p.x as usize, p.y as usize);
            if p.x >= 0.0 && p.y >= 0.0 && x < wide && y < wide {
                let passes = &mut passes[y * wide + x];
                seen += *passes;
                *passes *= 1.0 - share;
            }
        }
        let t = piece.span[0] + (piece.span[1] - piece.span[0]) * t;
        see(piece.vertex, seen * share * (1.0 - t));
        see(piece.vertex + 1, seen * share * t);
    }
}

/// How many fibres lie before each vertex of `strips` towards each light.
pub(super) fn fibers(strips: &[Strip], (middle, radius): (Vec3, f32)) -> Vec<[f32; LIGHTS.len()]> {
    let mut grid = vec![0.0f32; GRID * GRID * (GRID + 1)];
    let cell = 2.1 * radius / GRID as f32;
    let points = || strips.iter().flat_map(|strip| &strip.points);
    let mut fibers = vec![[0.0; LIGHTS.len()]; points().count()];
    for (i, back) in LIGHTS.into_iter().enumerate() {
        let (right, up, back) = axes(back);
        // Cells across and behind the light's side of the hair.
        let place = |p: Vec3| {
            let p = (p - middle) / cell;
            Vec3::new(p.dot(right), p.dot(up), -p.dot(back)) + 0.5 * GRID as f32
        };
        grid.fill(0.0);
        count(strips, cell.recip(), &mut grid, place);
        for column in grid.as_chunks_mut::<{ GRID + 1 }>().0 {
            let mut sum = 0.0;
            for cell in column {
                sum += std::mem::replace(cell, sum);
            }
        }
        for (p, fibers) in points().zip(&mut fibers) {
            fibers[i] = before(&grid, place(*p) - Vec3::Z * (BIAS / cell));
        }
    }
    fibers
}

/// Of what is seen, how many fibres lie before it towards the lights.
#[derive(Clone, Debug, Default)]
pub(super) struct Lit {
    /// Sums of what is seen and of its fibres, by the logarithm of these.
    bins: Vec<[f32; 2]>,
}

/// Bins per octave of fibres, the count where the first one ends, and how many there are.
const BINS: f32 = 4.0;
const FEWEST: f32 = 0.01;
const MOST_BINS: usize = 80;

impl Lit {
    /// Of vertices of which so much is `seen`, and before which lie `scale` times so many `fibers`.
    ///
    /// A fibre throws back more of what comes from the eye's side: as much as the eye sees of its lit half.
    pub(super) fn new(seen: &[Seen], fibers: &[[f32; LIGHTS.len()]], scale: f32) -> Self {
        let shares = LIGHTS.map(|light| EYES.map(|eye| 0.5 + 0.5 * eye.normalize().dot(light.normalize())));
        let mut bins = vec![[0.0; 2]; MOST_BINS];
        for (seen, fibers) in seen.iter().zip(fibers) {
            for (shares, fibers) in shares.iter().zip(fibers) {
                let seen: f32 = seen.iter().zip(shares).map(|(seen, share)| seen * share).sum();
                let fibers = scale * fibers;
                let bin = (BINS * (fibers / FEWEST).max(1e-3).log2()).max(0.0) as usize;
                let bin: &mut [f32; 2] = &mut bins[bin.min(MOST_BINS - 1)];
                bin[0] += seen;
                bin[1] += seen * fibers;
            }
        }
        Self { bins }
    }

    /// The mean share of the light that meets no fibre where each counts as `factor`.
    pub(super) fn light(&self, factor: f32) -> f32 {
        let (mut sum, mut all) = (0.0, 0.0);
        for [seen, fibers] in self.bins.iter().filter(|[seen, _]| *seen > 0.0) {
            sum += seen * (-factor * fibers / seen).exp();
            all += seen;
        }
        sum / all.max(1e-20)
    }

    /// What a fibre has to count as in `other` so that as much light arrives there as here.
    pub(super) fn matching(&self, other: &Self) -> f32 {
        let light = self.light(1.0);
        let (mut low, mut high) = (-2f32, 2f32);
        for _ in 0..16 {
            let middle = 0.5 * (low + high);
            if other.light(middle.exp2()) > light { low = middle } else { high = middle }
        }
        (0.5 * (low + high)).exp2()
    }
}

/// Adds the area of `strips`, in cells, to the cells they lie in: four side by side share it. `scale`: a
/// strip's width in cells over its own in metres.
fn count(strips: &[Strip], scale: f32, grid: &mut [f32], place: impl Fn(Vec3) -> Vec3) {
    for strip in strips {
        for (points, radii) in strip.points.windows(2).zip(strip.radii.windows(2)) {
            let (a, b) = (place(points[0]), place(points[1]));
            let way = b - a;
            let steps = way.abs().max_element().ceil().max(1.0);
            let amount = (radii[0] + radii[1]) * scale * way.truncate().length() / steps;
            for i in 0..steps as u32 {
                let at = a + way * ((i as f32 + 0.5) / steps);
                let z = at.z.clamp(0.0, (GRID - 1) as f32) as usize;
                for (column, weight) in columns(at) {
                    grid[column * (GRID + 1) + z] += amount * weight;
                }
            }
        }
    }
}

/// The fibres before a place, once the cells hold sums.
fn before(grid: &[f32], at: Vec3) -> f32 {
    let z = at.z.clamp(0.0, GRID as f32 - 1e-3);
    let k = z as usize;
    let of = |(column, weight): (usize, f32)| {
        let column = &grid[column * (GRID + 1)..];
        weight * (column[k] + (column[k + 1] - column[k]) * (z - k as f32))
    };
    columns(at).into_iter().map(of).sum()
}

/// The four columns about a place and their weights.
fn columns(at: Vec3) -> [(usize, f32); 4] {
    let at = (at.truncate() - 0.5).clamp(Vec2::ZERO, Vec2::splat(GRID as f32 - 1.001));
    let (x, y) = (at.x as usize, at.y as usize);
    let f = at - at.floor();
    let first = y * GRID + x;
    [
        (first, (1.0 - f.x) * (1.0 - f.y)),
        (first + 1, f.x * (1.0 - f.y)),
        (first + GRID, (1.0 - f.x) * f.y),
        (first + GRID + 1, f.x * f.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `layers` curtains of strands side by side, a metre large each, 10 cm behind each other from the
    /// front (+Z) on, that each cover `share` of what is behind them.
    fn curtains(layers: u32, share: f32) -> Vec<Strip> {
        let line = |i: u32| {
            let x = ((i / layers) as f32 + 0.5) / 200.0 - 0.5;
            let z = 0.1 * (0.5 * (layers - 1) as f32 - (i % layers) as f32);
            let points = [-0.5, 0.0, 0.5].map(|y| Vec3::new(x, y, z)).to_vec();
            Strip { points, radii: vec![0.5 * share / 200.0; 3] }
        };
        (0..200 * layers).map(line).collect()
    }

    #[test]
    fn the_nearest_is_seen_and_the_rest_through_it() {
        let strips = curtains(3, 0.4);
        let mut pictures = Pictures::new(&strips, (Vec3::ZERO, 0.8));
        let cell = 0.02;
        let seen = pictures.seen(1.0, cell);
        let of = |layer: usize| -> f32 {
            let strips = seen.chunks(3).enumerate().filter(|(i, _)| i % 3 == layer);
            strips.flat_map(|(_, seen)| seen).map(|seen| seen[0]).sum()
        };
        for layer in 1..3 {
            let ratio = of(layer) / of(layer - 1);
            // Four strands in no order, each a tenth of the cell.
            assert!((ratio - 0.9f32.powi(4)).abs() < 0.02, "{layer}: {ratio}");
        }
    }

    #[test]
    fn fibers_are_counted_towards_the_light() {
        let strips = curtains(3, 0.4);
        let fibers = fibers(&strips, (Vec3::ZERO, 0.8));
        // The light meets 0.4 per curtain, the more the more aslant it comes; at its own curtain half of that.
        let light = LIGHTS[0].normalize();
        let across = Vec2::new(light.x, light.z).normalize().y;
        for layer in 0..3 {
            // In the middle of the curtain.
            let strip = 100 * 3 + layer;
            let count = fibers[3 * strip + 1][0];
            let expected = 0.4 / across * (layer as f32 + 0.5);
            assert!((count - expected).abs() < 0.2, "{layer}: {count} {expected}");
        }
    }

    #[test]
    fn light_is_matched() {
        let seen = [[1.0, 0.0, 0.0]; 3];
        let lit = |scale| Lit::new(&seen, &[[0.5, 0.2], [2.0, 1.0], [4.0, 3.0]], scale);
        assert!((lit(1.0).matching(&lit(0.8)) - 1.25).abs() < 1e-2);
        assert!((lit(1.0).matching(&lit(1.0)) - 1.0).abs() < 1e-2);
        let one = Lit::new(&seen[..1], &[[2.0, 2.0]], 1.0);
        assert!((one.light(0.5) - (-1f32).exp()).abs() < 1e-3);
    }
}
