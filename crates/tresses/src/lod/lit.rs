//! Light on the visible parts of strands, on the CPU: fiber counts towards lights.

use super::visibility::{EYES, Strip, Visibility, axes};
use glam::{Vec2, Vec3};

/// Edge of a counting cell, meters: a texel of default shadow maps. Then the maximum number of cells per edge.
const TEXEL: f32 = 0.0026;
const FINEST: f32 = 341.0;
/// Distance within which fibers are not counted, meters: equals `NEAR` plus, for the angles between these eyes and
/// lights, `SHARED` of `light/transmittance.wesl`.
const BIAS: f32 = 0.00275;

/// Directions to the default lights: from the front, upper left, and from behind.
const LIGHTS: [Vec3; 2] = [Vec3::new(-0.42, 0.62, 0.66), Vec3::new(0.85, 0.28, -0.45)];

/// Counts the fibers in front of each vertex of `strips` towards each light as deep opacity maps do: in layers behind a
/// front formed by the strips `fronts`, each of which represents `wide` strips.
pub(super) fn fibers(
    strips: &[Strip],
    fronts: &[Strip],
    sphere: (Vec3, f32),
    wide: f32,
) -> Vec<[f32; LIGHTS.len()]> {
    let (center, radius) = sphere;
    let cell = TEXEL.max(2.1 * radius / FINEST);
    let grid = (2.1 * radius / cell).ceil() as usize;
    let length: f32 = fronts.iter().map(Strip::length).sum();
    let wide = wide.min((ENOUGH / (dense(length, radius) * cell).max(1e-6)).clamp(1.0, WIDEST));
    let points = || strips.iter().flat_map(|strip| &strip.points);
    let mut fibers = vec![[0.0; LIGHTS.len()]; points().count()];
    let mut map = DeepMap { grid, ..Default::default() };
    for (i, back) in LIGHTS.into_iter().enumerate() {
        let (right, up, back) = axes(back);
        // Cells across, and meters behind the light's side of the hair.
        let project = |p: Vec3| {
            let p = p - center;
            let across = Vec2::new(p.dot(right), p.dot(up)) / cell + 0.5 * grid as f32;
            across.extend(1.05 * radius - p.dot(back))
        };
        map.splat(strips, fronts, cell, wide, project);
        for (p, fibers) in points().zip(&mut fibers) {
            fibers[i] = map.before(project(*p));
        }
    }
    fibers
}

/// Returns the length of strands over the cross-section of a sphere with `radius` meters, 1/m.
pub(super) fn dense(length: f32, radius: f32) -> f32 {
    length / (std::f32::consts::PI * radius * radius).max(1e-12)
}

/// For the parts visible to each eye: the distribution of fiber counts towards each light.
#[derive(Clone, Debug)]
pub(super) struct LightDepths {
    /// Sums of visibility, and of visibility times fiber count, binned by the logarithm of the count.
    bins: [[Vec<[f32; 2]>; LIGHTS.len()]; EYES.len()],
}

/// Bins per octave of the fiber count, the count at which the first bin ends, and the number of bins.
const BINS: f32 = 4.0;
const FEWEST: f32 = 0.01;
const MAX_BINS: usize = 80;

impl LightDepths {
    /// Bins vertices by `scale` times their count in `fibers`, weighted by their visible fraction `seen`.
    pub(super) fn new(visibility: &[Visibility], fibers: &[[f32; LIGHTS.len()]], scale: f32) -> Self {
        let mut bins = EYES.map(|_| LIGHTS.map(|_| vec![[0.0; 2]; MAX_BINS]));
        for (fractions, fibers) in visibility.iter().zip(fibers) {
            for (light, fibers) in fibers.iter().enumerate() {
                let fibers = scale * fibers;
                let bin = (BINS * (fibers / FEWEST).max(1e-3).log2()).max(0.0) as usize;
                for (bins, visible) in bins.iter_mut().zip(fractions) {
                    let bin: &mut [f32; 2] = &mut bins[light][bin.min(MAX_BINS - 1)];
                    bin[0] += visible;
                    bin[1] += visible * fibers;
                }
            }
        }
        Self { bins }
    }

    /// Returns the factors on fiber counts in `other` for which as much light arrives at its visible parts as here: for
    /// a light on the eye's side, and for a light behind the hair.
    ///
    /// Through narrower strands the eye sees deeper: farther from a light beside the eye, nearer to one behind the
    /// hair. The factor's logarithm is taken as linear in the cosine of the angle between light and eye. Its slope is a
    /// least-squares fit to the factors of all pairs of eye and light; its offset makes the total light equal. Each
    /// pair is weighted by the light that it adds to an image, since a fiber reflects in proportion to the visible part
    /// of its lit half.
    pub(super) fn matching(&self, other: &Self) -> [f32; 2] {
        let pairs: Vec<_> = (0..EYES.len() * LIGHTS.len())
            .map(|pair| {
                let (i, k) = (pair / LIGHTS.len(), pair % LIGHTS.len());
                let near = 0.5 + 0.5 * EYES[i].normalize().dot(LIGHTS[k].normalize());
                (near, light_in(&self.bins[i][k], 1.0), &other.bins[i][k])
            })
            .collect();
        // Sums for the line fit: weights, abscissas, ordinates and their products.
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
        [behind + slope, behind].map(|power| power.clamp(-MAX_LOG2_FACTOR, MAX_LOG2_FACTOR).exp2())
    }
}

/// Maximum absolute value of a factor's base-2 logarithm.
const MAX_LOG2_FACTOR: f32 = 3.0;

/// Returns the mean share of the light that hits no fiber if each fiber counts as `factor`.
fn light_in(bins: &[[f32; 2]], factor: f32) -> f32 {
    let (mut sum, mut all) = (0.0, 0.0);
    for [visible, fibers] in bins.iter().filter(|[visible, _]| *visible > 0.0) {
        sum += visible * (-factor * fibers / visible).exp();
        all += visible;
    }
    sum / all.max(1e-20)
}

/// Returns the base-2 logarithm of the factor at which `light`, a decreasing function, equals `target`.
fn power(light: impl Fn(f32) -> f32, target: f32) -> f32 {
    let (mut low, mut high) = (-MAX_LOG2_FACTOR, MAX_LOG2_FACTOR);
    for _ in 0..16 {
        let midpoint = 0.5 * (low + high);
        if light(midpoint.exp2()) > target { low = midpoint } else { high = midpoint }
    }
    0.5 * (low + high)
}

/// Layers of a deep opacity map.
const LAYERS: usize = crate::constants::DEEP_LAYERS as usize;
/// Maximum width of a strip in the front, cells: `WIDEST` of `light/splat.wesl`.
const WIDEST: f32 = 6.0;
/// Strips in a cell that suffice to find its front: `ENOUGH` of `light/splat.wesl`.
const ENOUGH: f32 = 12.0;
/// Golden ratio: the fractional parts of its multiples are evenly distributed.
const GOLDEN: f32 = 0.618_034;

/// A deep opacity map (`light/deep.wesl`) with cells instead of texels.
#[derive(Default)]
struct DeepMap {
    /// Cells along each edge.
    grid: usize,
    /// Depth of the front in each cell, meters; infinite where there is no hair.
    fronts: Vec<f32>,
    /// Fibers in front of the far end of each layer.
    layers: Vec<[f32; LAYERS]>,
}

/// Same as `layer_of` in `light/deep.wesl`.
fn layer_of(depth: f32) -> f32 {
    if depth < 0.0 {
        return (depth / 0.012).max(-1.0);
    }
    (1.2 * (1.0 + depth / 0.004).log2()).min((LAYERS - 1) as f32)
}

impl DeepMap {
    /// Builds the map from `strips` with cells of `cell` meters. `project` maps positions to cells and depth.
    fn splat(
        &mut self,
        strips: &[Strip],
        fronts: &[Strip],
        cell: f32,
        wide: f32,
        project: impl Fn(Vec3) -> Vec3,
    ) {
        let grid = self.grid;
        let mut nearest = vec![f32::INFINITY; grid * grid];
        walk(fronts, &project, |strip, at, perpendicular, _| {
            // A whole number of cells per strip that has the width `wide` on average.
            let lanes = (wide + (strip as f32 * GOLDEN).fract()).floor();
            for lane in 0..lanes as u32 {
                let off = perpendicular * (lane as f32 - 0.5 * (lanes - 1.0));
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
        walk(strips, &project, |_, at, _, area| {
            for (column, weight) in columns(grid, at) {
                // Layers follow the front; strips far in front of it are in no layer.
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

    /// Returns the number of fibers in front of a position, except those too close to it.
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

/// Walks along `strips` from cell to cell. For each step, calls `visit` with the strip's index, the position, the axis
/// perpendicular to the strip, and the covered area divided by the edge of a cell (meters).
fn walk(strips: &[Strip], project: impl Fn(Vec3) -> Vec3, mut visit: impl FnMut(usize, Vec3, Vec2, f32)) {
    for (k, strip) in strips.iter().enumerate() {
        for (points, radii) in strip.points.windows(2).zip(strip.radii.windows(2)) {
            let a = project(points[0]);
            let delta = project(points[1]) - a;
            let across = delta.truncate().abs();
            let steps = across.max_element().ceil().max(1.0);
            let perpendicular = if across.x > across.y { Vec2::Y } else { Vec2::X };
            let area = (radii[0] + radii[1]) * delta.truncate().length() / steps;
            for i in 0..steps as u32 {
                visit(k, a + delta * ((i as f32 + 0.5) / steps), perpendicular, area);
            }
        }
    }
}

/// Returns the four columns around a position and their bilinear weights.
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
    use super::super::visibility::tests::curtains;
    use super::*;

    #[test]
    fn fibers_are_counted_towards_the_light() {
        let strips = curtains(3, 0.4);
        let fibers = fibers(&strips, &strips, (Vec3::ZERO, 0.8), 1.0);
        // Each curtain adds 0.4 fibers at normal incidence, more at grazing angles. A strand's own curtain counts half.
        let light = LIGHTS[0].normalize();
        let across = Vec2::new(light.x, light.z).normalize().y;
        for layer in 0..3 {
            // A strand in the middle of the curtain.
            let strip = 100 * 3 + layer;
            let count = fibers[3 * strip + 1][0];
            let expected = 0.4 / across * (layer as f32 + 0.5);
            // Layers that far behind the front are thicker than a curtain, so the count is coarse.
            assert!((count - expected).abs() < 0.01 + 0.2 / across, "{layer}: {count} {expected}");
        }
    }

    #[test]
    fn matching_recovers_fiber_scale() {
        let seen = [[1.0; 3]; 3];
        let lit = |scale| LightDepths::new(&seen, &[[0.5, 0.2], [2.0, 1.0], [4.0, 3.0]], scale);
        for (scale, factor) in [(0.8, 1.25), (1.0, 1.0)] {
            for matched in lit(1.0).matching(&lit(scale)) {
                assert!((matched - factor).abs() < 1e-2, "{scale}: {matched}");
            }
        }
        let one = LightDepths::new(&seen[..1], &[[2.0; 2]], 1.0);
        assert!((light_in(&one.bins[0][0], 0.5) - (-1f32).exp()).abs() < 1e-3);
    }

    #[test]
    fn seeing_deeper_lowers_front_factor_and_raises_back_factor() {
        // Two layers towards each light. Eyes on the side that a layer faces see all of it, the others the share
        // `through`.
        let seen = |through: f32| -> Vec<Visibility> {
            let of = |eye: Vec3, light: Vec3| if eye.dot(light) > 0.0 { 1.0 } else { through };
            let layer = |light: Vec3| EYES.map(|eye| of(eye, light));
            LIGHTS.into_iter().flat_map(|light| [layer(light), layer(-light)]).collect()
        };
        let fibers: Vec<[f32; 2]> = vec![[0.1, 9.0], [3.0, 9.0], [9.0, 0.1], [9.0, 3.0]];
        let full = LightDepths::new(&seen(0.1), &fibers, 1.0);
        let [before, behind] = full.matching(&LightDepths::new(&seen(0.5), &fibers, 1.0));
        assert!(before < 1.0 && behind > 1.0, "{before} {behind}");
    }
}
