//! How much light reaches the visible parts of strands, on the CPU: fibre counts towards lights.

use super::seen::{EYES, Seen, Strip, axes};
use glam::{Vec2, Vec3};

/// Fibres are counted in cells as large as texels of shadow maps as they are by default: that long, metres, or as many
/// along each edge.
const TEXEL: f32 = 0.0026;
const FINEST: f32 = 341.0;
/// How near fibres are not counted, metres: what `NEAR` and, for eyes and lights as far apart as these, `SHARED`
/// of `light/transmittance.wesl` come to.
const BIAS: f32 = 0.00275;

/// From the upper side before, and from behind: the default lights.
const LIGHTS: [Vec3; 2] = [Vec3::new(-0.42, 0.62, 0.66), Vec3::new(0.85, 0.28, -0.45)];

/// How many fibres lie before each vertex of `strips` towards each light, as deep opacity maps count them:
/// in layers behind a front that `fronts` leave, strips of which each stands for `wide`.
pub(super) fn fibers(
    strips: &[Strip],
    fronts: &[Strip],
    sphere: (Vec3, f32),
    wide: f32,
) -> Vec<[f32; LIGHTS.len()]> {
    let (middle, radius) = sphere;
    let cell = TEXEL.max(2.1 * radius / FINEST);
    let grid = (2.1 * radius / cell).ceil() as usize;
    let length: f32 = fronts.iter().map(Strip::length).sum();
    let wide = wide.min((ENOUGH / (dense(length, radius) * cell).max(1e-6)).clamp(1.0, WIDEST));
    let points = || strips.iter().flat_map(|strip| &strip.points);
    let mut fibers = vec![[0.0; LIGHTS.len()]; points().count()];
    let mut map = DeepMap { grid, ..Default::default() };
    for (i, back) in LIGHTS.into_iter().enumerate() {
        let (right, up, back) = axes(back);
        // Cells across, metres behind the light's side of the hair.
        let place = |p: Vec3| {
            let p = p - middle;
            let across = Vec2::new(p.dot(right), p.dot(up)) / cell + 0.5 * grid as f32;
            across.extend(1.05 * radius - p.dot(back))
        };
        map.lay(strips, fronts, cell, wide, place);
        for (p, fibers) in points().zip(&mut fibers) {
            fibers[i] = map.before(place(*p));
        }
    }
    fibers
}

/// Length of strands over the area of the disc that they lie in, in a sphere of `radius` metres, 1/m.
pub(super) fn dense(length: f32, radius: f32) -> f32 {
    length / (std::f32::consts::PI * radius * radius).max(1e-12)
}

/// Of what each eye sees, how many fibres lie before it towards each light.
#[derive(Clone, Debug)]
pub(super) struct Lit {
    /// Sums of what is seen and of its fibres, by the logarithm of these.
    bins: [[Vec<[f32; 2]>; LIGHTS.len()]; EYES.len()],
}

/// Bins per octave of fibres, the count where the first one ends, and how many there are.
const BINS: f32 = 4.0;
const FEWEST: f32 = 0.01;
const MOST_BINS: usize = 80;

impl Lit {
    /// Of vertices of which so much is `seen`, and before which lie `scale` times so many `fibers`.
    pub(super) fn new(seen: &[Seen], fibers: &[[f32; LIGHTS.len()]], scale: f32) -> Self {
        let mut bins = EYES.map(|_| LIGHTS.map(|_| vec![[0.0; 2]; MOST_BINS]));
        for (seen, fibers) in seen.iter().zip(fibers) {
            for (light, fibers) in fibers.iter().enumerate() {
                let fibers = scale * fibers;
                let bin = (BINS * (fibers / FEWEST).max(1e-3).log2()).max(0.0) as usize;
                for (bins, seen) in bins.iter_mut().zip(seen) {
                    let bin: &mut [f32; 2] = &mut bins[light][bin.min(MOST_BINS - 1)];
                    bin[0] += seen;
                    bin[1] += seen * fibers;
                }
            }
        }
        Self { bins }
    }

    /// What fibres have to count as in `other` so that as much light arrives at what is seen there as here: where
    /// a light comes from the eye's side, and where it comes from behind the hair.
    ///
    /// Through narrower strands the eye sees deeper: further from a light beside it, nearer to one behind. Between
    /// the two a factor's logarithm is straight over the cosine of the angle between light and eye: as steep as
    /// comes nearest (in squares) to the factors of all eyes and lights, and as high as gives all of them together
    /// as much light. Each counts as the light that it adds to a picture; a fibre reflects in proportion to the part of
    /// its lit half that the eye sees.
    pub(super) fn matching(&self, other: &Self) -> [f32; 2] {
        let pairs: Vec<_> = (0..EYES.len() * LIGHTS.len())
            .map(|pair| {
                let (i, k) = (pair / LIGHTS.len(), pair % LIGHTS.len());
                let near = 0.5 + 0.5 * EYES[i].normalize().dot(LIGHTS[k].normalize());
                (near, light_in(&self.bins[i][k], 1.0), &other.bins[i][k])
            })
            .collect();
        // Sums of the weights, of what the line is laid through, and of their products.
        let (mut n, mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (near, light, level) in &pairs {
            let (weight, logarithm) = (near * light, power(|factor| light_in(level, factor), *light));
            (n, x, y) = (n + weight, x + weight * near, y + weight * logarithm);
            (xx, xy) = (xx + weight * near * near, xy + weight * near * logarithm);
        }
        let spread = n * xx - x * x;
        let slope = if spread > 1e-6 * n * n { (n * xy - x * y) / spread } else { 0.0 };
        let all = |factor: f32| -> f32 {
            pairs.iter().map(|(near, _, level)| near * light_in(level, factor * (slope * near).exp2())).sum()
        };
        let behind = power(all, n);
        [behind + slope, behind].map(|power| power.clamp(-MOST_MATCHED, MOST_MATCHED).exp2())
    }
}

/// Powers of two: no factor is larger, or smaller than its reciprocal.
const MOST_MATCHED: f32 = 3.0;

/// The mean share of the light that meets no fibre where each counts as `factor`.
fn light_in(bins: &[[f32; 2]], factor: f32) -> f32 {
    let (mut sum, mut all) = (0.0, 0.0);
    for [seen, fibers] in bins.iter().filter(|[seen, _]| *seen > 0.0) {
        sum += seen * (-factor * fibers / seen).exp();
        all += seen;
    }
    sum / all.max(1e-20)
}

/// The logarithm (to base 2) of the factor with which `light`, which falls as it grows, is `wanted`.
fn power(light: impl Fn(f32) -> f32, wanted: f32) -> f32 {
    let (mut low, mut high) = (-MOST_MATCHED, MOST_MATCHED);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if light(middle.exp2()) > wanted { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Layers of a deep opacity map.
const LAYERS: usize = crate::constants::DEEP_LAYERS as usize;
/// The most cells of the front that a strip lies in side by side: `WIDEST` of `light/splat.wesl`.
const WIDEST: f32 = 6.0;
/// So many strips in a cell find its front: `ENOUGH` of `light/splat.wesl`.
const ENOUGH: f32 = 12.0;
/// Multiples of it are spread evenly over the fractions.
const GOLDEN: f32 = 0.618_034;

/// A deep opacity map (`light/deep.wesl`), cells for texels.
#[derive(Default)]
struct DeepMap {
    /// Cells along each edge.
    grid: usize,
    /// Metres, of each cell; infinite where there is no hair.
    fronts: Vec<f32>,
    /// Fibres before the far end of each layer.
    layers: Vec<[f32; LAYERS]>,
}

/// Twin of `layer_of` in `light/deep.wesl`.
fn layer_of(way: f32) -> f32 {
    if way < 0.0 {
        return (way / 0.012).max(-1.0);
    }
    (1.2 * (1.0 + way / 0.004).log2()).min((LAYERS - 1) as f32)
}

impl DeepMap {
    /// Of `strips`, with cells of `cell` metres; `place` tells where they are.
    fn lay(
        &mut self,
        strips: &[Strip],
        fronts: &[Strip],
        cell: f32,
        wide: f32,
        place: impl Fn(Vec3) -> Vec3,
    ) {
        let grid = self.grid;
        let mut nearest = vec![f32::INFINITY; grid * grid];
        walk(fronts, &place, |strip, at, aside, _| {
            // As many whole cells as give that width on average.
            let lanes = (wide + (strip as f32 * GOLDEN).fract()).floor();
            for lane in 0..lanes as u32 {
                let off = aside * (lane as f32 - 0.5 * (lanes - 1.0));
                let (x, y) = (at.x + off.x, at.y + off.y);
                if x >= 0.0 && y >= 0.0 && x < grid as f32 && y < grid as f32 {
                    let nearest = &mut nearest[y as usize * grid + x as usize];
                    *nearest = nearest.min(at.z);
                }
            }
        });
        self.fronts.clear();
        self.fronts.extend((0..grid * grid).map(|at| {
            let around = |at: usize| at.saturating_sub(1)..(at + 2).min(grid);
            let (mut sum, mut count) = (0.0, 0.0);
            for y in around(at / grid) {
                for near in around(at % grid).map(|x| nearest[y * grid + x]).filter(|near| near.is_finite()) {
                    (sum, count) = (sum + near, count + 1.0);
                }
            }
            if count > 0.0 { sum / count } else { f32::INFINITY }
        }));
        self.layers.clear();
        self.layers.resize(grid * grid, [0.0; LAYERS]);
        walk(strips, &place, |_, at, _, area| {
            for (column, weight) in columns(grid, at) {
                // The layers follow the front: what is far before it is in none.
                let layer = layer_of(at.z - self.fronts[column]).floor() + 1.0;
                self.layers[column][(layer as usize).min(LAYERS - 1)] += weight * area / cell;
            }
        });
        for layers in &mut self.layers {
            let mut sum = 0.0;
            for layer in layers {
                sum += *layer;
                *layer = sum;
            }
        }
    }

    /// The fibres before a place, those too near to it left out.
    fn before(&self, at: Vec3) -> f32 {
        let of = |(column, weight): (usize, f32)| {
            let (layer, layers) = (layer_of(at.z - BIAS - self.fronts[column]), &self.layers[column]);
            if layer < 0.0 {
                return weight * layers[0] * (1.0 + layer);
            }
            let k = (layer as usize).min(LAYERS - 2);
            weight * (layers[k] + (layers[k + 1] - layers[k]) * (layer - k as f32))
        };
        columns(self.grid, at).into_iter().map(of).sum()
    }
}

/// Tells of each step of `strips` from cell to cell of which it is, where it is, which way lies aside, and the area over the
/// edge of a cell (metres) that a step covers.
fn walk(strips: &[Strip], place: impl Fn(Vec3) -> Vec3, mut see: impl FnMut(usize, Vec3, Vec2, f32)) {
    for (k, strip) in strips.iter().enumerate() {
        for (points, radii) in strip.points.windows(2).zip(strip.radii.windows(2)) {
            let a = place(points[0]);
            let way = place(points[1]) - a;
            let across = way.truncate().abs();
            let steps = across.max_element().ceil().max(1.0);
            let aside = if across.x > across.y { Vec2::Y } else { Vec2::X };
            let area = (radii[0] + radii[1]) * way.truncate().length() / steps;
            for i in 0..steps as u32 {
                see(k, a + way * ((i as f32 + 0.5) / steps), aside, area);
            }
        }
    }
}

/// The four columns about a place and their weights.
fn columns(grid: usize, at: Vec3) -> [(usize, f32); 4] {
    let at = (at.truncate() - 0.5).clamp(Vec2::ZERO, Vec2::splat(grid as f32 - 1.001));
    let (x, y) = (at.x as usize, at.y as usize);
    let f = at - at.floor();
    let first = y * grid + x;
    [
        (first, (1.0 - f.x) * (1.0 - f.y)),
        (first + 1, f.x * (1.0 - f.y)),
        (first + grid, (1.0 - f.x) * f.y),
        (first + grid + 1, f.x * f.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::seen::tests::curtains;
    use super::*;

    #[test]
    fn fibers_are_counted_towards_the_light() {
        let strips = curtains(3, 0.4);
        let fibers = fibers(&strips, &strips, (Vec3::ZERO, 0.8), 1.0);
        // The light meets 0.4 per curtain, the more the more aslant it comes; at its own curtain half of that.
        let light = LIGHTS[0].normalize();
        let across = Vec2::new(light.x, light.z).normalize().y;
        for layer in 0..3 {
            // In the middle of the curtain.
            let strip = 100 * 3 + layer;
            let count = fibers[3 * strip + 1][0];
            let expected = 0.4 / across * (layer as f32 + 0.5);
            // A layer so far behind the front is thicker than a curtain: of that anything may be counted.
            assert!((count - expected).abs() < 0.01 + 0.2 / across, "{layer}: {count} {expected}");
        }
    }

    #[test]
    fn light_is_matched() {
        let seen = [[1.0; 3]; 3];
        let lit = |scale| Lit::new(&seen, &[[0.5, 0.2], [2.0, 1.0], [4.0, 3.0]], scale);
        for (scale, factor) in [(0.8, 1.25), (1.0, 1.0)] {
            for matched in lit(1.0).matching(&lit(scale)) {
                assert!((matched - factor).abs() < 1e-2, "{scale}: {matched}");
            }
        }
        let one = Lit::new(&seen[..1], &[[2.0; 2]], 1.0);
        assert!((light_in(&one.bins[0][0], 0.5) - (-1f32).exp()).abs() < 1e-3);
    }

    #[test]
    fn what_is_seen_deeper_is_lit_less_from_before_and_more_from_behind() {
        // Two layers, towards each light: of the first the more is seen by eyes on its side.
        let seen = |through: f32| -> Vec<Seen> {
            let of = |eye: Vec3, light: Vec3| if eye.dot(light) > 0.0 { 1.0 } else { through };
            let layer = |light: Vec3| EYES.map(|eye| of(eye, light));
            LIGHTS.into_iter().flat_map(|light| [layer(light), layer(-light)]).collect()
        };
        let fibers: Vec<[f32; 2]> = vec![[0.1, 9.0], [3.0, 9.0], [9.0, 0.1], [9.0, 3.0]];
        let full = Lit::new(&seen(0.1), &fibers, 1.0);
        let [before, behind] = full.matching(&Lit::new(&seen(0.5), &fibers, 1.0));
        assert!(before < 1.0 && behind > 1.0, "{before} {behind}");
    }
}
