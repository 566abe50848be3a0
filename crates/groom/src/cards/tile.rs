//! Tiles: pictures of locks in the frames of their ribbons.

use super::{lines::Lines, ribbon::Ribbon, strip::samples};
use crate::{hash::pcg, random::smoothstep};
use glam::{Vec2, Vec3};

/// Samples per texel along each axis.
const FINE: usize = 4;
/// Parts of a curve between two vertices of a strand.
const PARTS: usize = 3;
/// Longest extension of strands to the start of the ribbon, as a share of its length.
const ROOTS: f32 = 0.15;

/// A lock with the ribbon in whose frame it is drawn.
#[derive(Clone, Debug)]
pub(super) struct Lock {
    pub(super) members: Vec<u32>,
    pub(super) ribbon: Ribbon,
}

/// Coverage and attributes of a texel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Texel {
    /// Fraction of the texel that strands cover.
    pub(super) coverage: f32,
    /// Height over the ribbon, meters.
    pub(super) depth: f32,
    /// Direction of the strands: across the ribbon, along it, and out of it.
    pub(super) tangent: Vec3,
    /// Position on the strand, 0 root, 1 tip.
    pub(super) along: f32,
    /// Random number of the strand, 0 to 1.
    pub(super) seed: f32,
    /// Color from the file, linear, or white.
    pub(super) color: Vec3,
    /// Light that reaches the strand past those in front of it, 0 to 1.
    pub(super) shade: f32,
}

impl Texel {
    /// Adds the attributes of `other`, weighted.
    fn add(&mut self, other: &Self, weight: f32) {
        self.depth += weight * other.depth;
        self.tangent += weight * other.tangent;
        self.along += weight * other.along;
        self.seed += weight * other.seed;
        self.color += weight * other.color;
        self.shade += weight * other.shade;
    }

    fn scaled(&self, scale: f32) -> Self {
        let mut scaled = Self { coverage: self.coverage, ..Self::default() };
        scaled.add(self, scale);
        scaled
    }
}

/// A rectangle of texels.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) texels: Vec<Texel>,
}

/// A vertex of a strand in a tile.
#[derive(Clone, Copy)]
struct Vertex {
    at: Vec2,
    half: f32,
    depth: f32,
}

impl Vertex {
    /// Returns the vertex at a fraction between the middle two of four vertices, on a Catmull-Rom curve.
    fn between([a, b, c, d]: [&Self; 4], t: f32) -> Self {
        let weights = [
            -0.5 * t * (1.0 - t).powi(2),
            1.0 + t * t * (1.5 * t - 2.5),
            0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
            -0.5 * t * t * (1.0 - t),
        ];
        let mean = |of: fn(&Self) -> f32| [a, b, c, d].iter().zip(weights).map(|(v, w)| of(v) * w).sum();
        Self {
            at: Vec2::new(mean(|v| v.at.x), mean(|v| v.at.y)),
            half: b.half + (c.half - b.half) * t,
            depth: mean(|v| v.depth),
        }
    }
}

/// Nearest segment in a sample.
#[derive(Clone, Copy)]
struct Nearest {
    depth: f32,
    strand: u32,
    vertex: u32,
    t: f32,
}

const NOTHING: Nearest = Nearest { depth: f32::NEG_INFINITY, strand: u32::MAX, vertex: 0, t: 0.0 };

impl Lock {
    /// Root mean square of the slope of the strands against the ribbon.
    pub(super) fn slope(&self, lines: &Lines<'_>) -> f32 {
        let (mut sum, mut total) = (0.0, 0.0);
        self.each(lines, |_, strand| {
            for edge in strand.windows(2) {
                let delta = edge[1].at - edge[0].at;
                let (x, y) = (delta.x * self.ribbon.half(), delta.y * self.ribbon.length);
                let long = x.hypot(y);
                sum += long * (x / y.abs().max(1e-6)).powi(2).min(4.0);
                total += long;
            }
        });
        (sum / f32::max(total, 1e-9)).sqrt()
    }

    /// Returns the median distance of the roots from the start of the ribbon, as a share of its length. All strands are
    /// drawn that much earlier, so that no skin shows at a parting where other locks have the same picture.
    fn before(&self, lines: &Lines<'_>) -> f32 {
        let root = |i: &u32| self.ribbon.flat(lines.strand(*i).0[0], 0.0).at.y;
        let mut starts: Vec<f32> = self.members.iter().map(root).collect();
        starts.sort_by(f32::total_cmp);
        starts.get(starts.len() / 2).map_or(0.0, |start| start.clamp(0.0, ROOTS))
    }

    /// Calls `visit` with each strand in the frame of the ribbon. Widths stay in meters.
    fn each(&self, lines: &Lines<'_>, mut visit: impl FnMut(u32, &[Vertex])) {
        let mut vertices = Vec::new();
        for i in &self.members {
            let (points, radii) = lines.strand(*i);
            vertices.clear();
            let mut guess = 0.0;
            vertices.extend(points.iter().zip(radii).map(|(p, radius)| {
                let flat = self.ribbon.flat(*p, guess);
                guess = flat.at.y.clamp(0.0, 1.0);
                Vertex { at: flat.at, half: *radius, depth: flat.depth }
            }));
            visit(*i, &vertices);
        }
    }

    /// Draws the lock with the widths of its strands scaled by `widening`.
    pub(super) fn draw(&self, lines: &Lines<'_>, [width, height]: [usize; 2], widening: f32) -> Tile {
        let fine = [width * FINE, height * FINE];
        let size = Vec2::new(fine[0] as f32, fine[1] as f32);
        let mut nearest = vec![NOTHING; fine[0] * fine[1]];
        let before = self.before(lines);
        // Meters per sample.
        let (across, down) = (2.0 * self.ribbon.half() / size.x, self.ribbon.length / size.y);
        self.each(lines, |strand, vertices| {
            let last = vertices.len() - 1;
            let curve = |k: usize, j: usize| {
                let of = [k.saturating_sub(1), k, k + 1, (k + 2).min(last)].map(|i| &vertices[i]);
                Vertex::between(of, j as f32 / PARTS as f32)
            };
            let root = vertices[0];
            let skin = Vertex { at: Vec2::new(root.at.x, (root.at.y - before).max(0.0)), ..root };
            let start = (root.at.y > skin.at.y).then_some((0, [0.0; 2], [skin, root]));
            let parts = (0..last * PARTS).map(|i| {
                let (k, j) = (i / PARTS, i % PARTS);
                let [from, to] = [j, j + 1].map(|j| j as f32 / PARTS as f32);
                (k as u32, [from, to], [curve(k, j), curve(k, j + 1)])
            });
            for (k, [from, to], edge) in start.into_iter().chain(parts) {
                let to_samples = |v: &Vertex| Vec2::new(0.5 * v.at.x + 0.5, v.at.y) * size;
                let (a, b) = (to_samples(&edge[0]), to_samples(&edge[1]));
                let delta = (b - a).abs();
                let real = Vec2::new(delta.x * across, delta.y * down);
                // A strip is as wide along its minor axis as in space.
                let scale = match delta.y > delta.x {
                    true => {
                        (1.0 + (real.x / real.y).powi(2)).sqrt()
                            / ((1.0 + (delta.x / delta.y).powi(2)).sqrt() * across)
                    }
                    false => {
                        (1.0 + (real.y / real.x.max(1e-12)).powi(2)).sqrt()
                            / ((1.0 + (delta.y / delta.x.max(1e-9)).powi(2)).sqrt() * down)
                    }
                };
                let half = [widening * edge[0].half * scale, widening * edge[1].half * scale];
                samples([a, b], half, fine, |at, t| {
                    let depth = edge[0].depth + (edge[1].depth - edge[0].depth) * t;
                    if depth > nearest[at].depth {
                        nearest[at] = Nearest { depth, strand, vertex: k, t: from + (to - from) * t };
                    }
                });
            }
        });
        let texels = (0..width * height)
            .map(|i| self.resolve(lines, &nearest, fine[0], i % width, i / width))
            .collect();
        let mut tile = Tile { width, height, texels };
        tile.shade(self.ribbon.widest());
        tile
    }

    /// Averages the samples of a texel.
    fn resolve(&self, lines: &Lines<'_>, nearest: &[Nearest], wide: usize, x: usize, y: usize) -> Texel {
        let mut sum = Texel::default();
        let mut count = 0;
        let row = self.ribbon.row((y as f32 + 0.5) * FINE as f32 / (nearest.len() / wide) as f32);
        for k in 0..FINE * FINE {
            let found = nearest[(y * FINE + k / FINE) * wide + x * FINE + k % FINE];
            if found.strand == u32::MAX {
                continue;
            }
            let (points, _) = lines.strand(found.strand);
            let k = found.vertex as usize;
            let direction = (points[k + 1] - points[k]).normalize_or_zero();
            let color = match lines.strands.colors.get(lines.strands.range(found.strand as usize).start + k) {
                Some(color) => *color,
                None => Vec3::ONE,
            };
            sum.add(
                &Texel {
                    coverage: 0.0,
                    depth: found.depth,
                    tangent: Vec3::new(
                        direction.dot(row.side),
                        direction.dot(row.along),
                        direction.dot(row.out),
                    ),
                    along: (k as f32 + found.t) / (points.len() - 1) as f32,
                    seed: pcg(found.strand) as f32 / u32::MAX as f32,
                    color,
                    shade: 1.0,
                },
                1.0,
            );
            count += 1;
        }
        if count == 0 {
            return Texel::default();
        }
        let mut mean = sum.scaled(1.0 / count as f32);
        mean.coverage = count as f32 / (FINE * FINE) as f32;
        mean
    }
}

impl Tile {
    /// Darkens strands below the surface: by 1/e at a depth of half the ribbon's width.
    fn shade(&mut self, width: f32) {
        const RADIUS: usize = 2;
        let (w, h) = (self.width, self.height);
        let covered = |i: usize| self.texels[i].coverage > 0.0;
        let top = |x: usize, y: usize| {
            let near = (y.saturating_sub(RADIUS)..(y + RADIUS + 1).min(h))
                .flat_map(|y| (x.saturating_sub(RADIUS)..(x + RADIUS + 1).min(w)).map(move |x| y * w + x));
            near.filter(|i| covered(*i)).map(|i| self.texels[i].depth).fold(f32::NEG_INFINITY, f32::max)
        };
        let tops: Vec<f32> = (0..w * h).map(|i| top(i % w, i / w)).collect();
        for (texel, top) in self.texels.iter_mut().zip(tops) {
            if texel.coverage > 0.0 {
                texel.shade = (-(top - texel.depth) / (0.5 * width).max(1e-4)).exp();
            }
        }
    }

    /// Gives texels without strands the attributes of those around them, so that filters find no edges.
    pub(super) fn spread(&mut self) {
        fill(&mut self.texels, self.width, self.height);
    }
}

/// Fills texels without coverage from means over growing squares (pull and push, Gortler et al. 1996).
fn fill(texels: &mut [Texel], width: usize, height: usize) {
    if width * height <= 1 {
        return;
    }
    let (w, h) = (width.div_ceil(2), height.div_ceil(2));
    let mean = |i: usize| {
        let (x, y) = (i % w * 2, i / w * 2);
        let mut sum = Texel::default();
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            if x + dx < width && y + dy < height {
                let texel = &texels[(y + dy) * width + x + dx];
                sum.add(texel, texel.coverage);
                sum.coverage += texel.coverage;
            }
        }
        if sum.coverage > 0.0 { sum.scaled(1.0 / sum.coverage) } else { sum }
    };
    let mut coarse: Vec<Texel> = (0..w * h).map(mean).collect();
    fill(&mut coarse, w, h);
    for (i, texel) in texels.iter_mut().enumerate() {
        if texel.coverage == 0.0 {
            *texel = Texel { coverage: 0.0, ..coarse[i / width / 2 * w + i % width / 2] };
        }
    }
}

/// Returns the brightness of a strand with the random number `seed` at the fraction `along`: roots are darker.
pub(super) fn lightness(seed: f32, along: f32) -> f32 {
    (0.8 + 0.2 * seed) * (0.75 + 0.25 * smoothstep(0.0, 0.2, along))
}
