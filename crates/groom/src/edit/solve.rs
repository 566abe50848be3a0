//! The solve after every tool has moved the vertices of a guide: edges get their lengths back, parts beside
//! the brush keep their shape, and nothing enters the head.

use crate::SdfGrid;
use glam::Vec3;

/// Distance that combed hair keeps from the skin, if it had it, meters.
pub(super) const CLEARANCE: f32 = 1.5e-3;
/// Largest distance from the skin that a brush preserves, meters.
const MAX_VOLUME: f32 = 0.015;
/// Smallest radius to which a stroke bends hair, meters.
pub(super) const BEND: f32 = 6e-3;
/// Error of a distance field, meters.
const SLACK: f32 = 2e-3;
/// Passes of FABRIK: enough for 2 mm.
const PASSES: u32 = 6;
/// Bisections of a turn out of the head.
const BISECTIONS: u32 = 6;

/// A guide when the stroke began.
#[derive(Clone, Debug)]
pub(super) struct PressState {
    /// The vertices, meters.
    pub at: Vec<Vec3>,
    /// Lengths of the edges, meters.
    pub lengths: Vec<f32>,
    /// Distance from the skin that each vertex keeps, meters; below 0 for vertices that began inside.
    pub clear: Vec<f32>,
    /// Distance from the skin that each vertex had, meters.
    pub volume: Vec<f32>,
    /// Factor of the length since then.
    pub growth: f32,
}

impl PressState {
    pub fn new(guide: &[Vec3], field: Option<&SdfGrid>) -> Self {
        let volume: Vec<f32> = match field {
            Some(field) => guide.iter().map(|p| field.sample(*p)).collect(),
            None => vec![f32::MAX; guide.len()],
        };
        Self {
            at: guide.to_vec(),
            lengths: guide.windows(2).map(|edge| edge[0].distance(edge[1])).collect(),
            clear: volume.iter().map(|distance| distance.min(CLEARANCE)).collect(),
            volume,
            growth: 1.0,
        }
    }

    /// Returns the state of a guide that grows by `factor`.
    pub fn scaled(&self, factor: f32) -> Self {
        let lengths = self.lengths.iter().map(|length| length * factor).collect();
        Self { lengths, growth: self.growth * factor, ..self.clone() }
    }

    /// Whether `p`, where vertex `i` is now, is certainly farther from the skin than `distance`, meters: it has not
    /// moved far enough to be nearer.
    pub fn is_clear(&self, i: usize, p: Vec3, distance: f32) -> bool {
        let left = self.volume[i] - distance - SLACK;
        left > 0.0 && (p - self.at[i]).length_squared() < left * left
    }
}

/// Inputs of the solve: brush settings and the head.
#[derive(Clone, Copy)]
pub(super) struct Solver<'a> {
    pub field: Option<&'a SdfGrid>,
    pub keep_shape: f32,
    pub keep_volume: f32,
    /// Smallest radius to which hair is bent, meters; `None` for any.
    pub bend: Option<f32>,
}

/// Returns `v` rotated by the smallest rotation from the direction `a` to the direction `b`, both units.
pub(super) fn rotate_between(v: Vec3, a: Vec3, b: Vec3) -> Vec3 {
    let (c, cosine) = (a.cross(b), a.dot(b));
    if cosine < -0.9999 {
        // Opposite: a half turn about any axis across.
        let axis = if a.x.abs() > a.z.abs() { Vec3::new(-a.y, a.x, 0.0) } else { Vec3::new(0.0, -a.z, a.y) };
        let axis = unit(axis, Vec3::X);
        return axis * (2.0 * axis.dot(v)) - v;
    }
    v + c.cross(v) + c.cross(c.cross(v)) / (1.0 + cosine)
}

/// Returns `v` with length 1, or `other` if it has none.
pub(super) fn unit(v: Vec3, other: Vec3) -> Vec3 {
    let length = v.length();
    if length > 1e-9 && length.is_finite() { v / length } else { other }
}

/// Returns `direction`, turned towards the edge before it if the angle between them is larger than `angle` and than the
/// one with the cosine `sharpest`.
fn bent(direction: Vec3, before: Vec3, angle: f32, sharpest: f32) -> Vec3 {
    let cosine = (1.0 - 0.5 * angle * angle).max(0.0).min(sharpest);
    if direction.dot(before) >= cosine {
        return direction;
    }
    let across = unit(direction - before * direction.dot(before), Vec3::ZERO);
    before * cosine + across * (1.0 - cosine * cosine).max(0.0).sqrt()
}

impl Solver<'_> {
    /// Returns the guide that was at `before` and whose vertices a tool moved to `target`. `near` is the falloff at
    /// each vertex: 1 in the middle of the brush, 0 outside. Vertices before `first` keep their bits.
    pub fn solve(
        &self,
        before: &[Vec3],
        target: &[Vec3],
        near: &[f32],
        first: usize,
        press: &PressState,
    ) -> Vec<Vec3> {
        let n = before.len();
        let mut line = before.to_vec();
        let edge_before = |i: usize| unit(before[i + 1] - before[i], Vec3::Y);
        for i in first.max(1) - 1..n - 1 {
            let length = press.lengths[i];
            let transported = match i {
                0 => edge_before(0),
                _ => rotate_between(
                    edge_before(i),
                    edge_before(i - 1),
                    unit(line[i] - line[i - 1], edge_before(i - 1)),
                ),
            };
            let toward_target = unit(target[i + 1] - line[i], transported);
            let keep = self.keep_shape * (1.0 - near[i + 1]);
            let direction = unit(toward_target * (1.0 - keep) + transported * keep, transported);
            let direction = match self.bend {
                Some(radius) if i > 0 => {
                    let sharpest = edge_before(i).dot(edge_before(i - 1));
                    bent(direction, unit(line[i] - line[i - 1], direction), length / radius, sharpest)
                }
                _ => direction,
            };
            line[i + 1] = self.outside(line[i], direction, length, i + 1, press, transported);
        }
        line
    }

    /// Returns the end of the edge from `start` in `direction`, turned out of the head if it is too deep.
    fn outside(
        &self,
        start: Vec3,
        direction: Vec3,
        length: f32,
        vertex: usize,
        press: &PressState,
        transported: Vec3,
    ) -> Vec3 {
        let end = |direction: Vec3| start + direction * length;
        let Some(field) = self.field else { return end(direction) };
        let min_distance = press.clear[vertex];
        let wish = min_distance.max((self.keep_volume * press.volume[vertex]).min(MAX_VOLUME));
        let (mut corrected_direction, mut p) = (direction, end(direction));
        if press.is_clear(vertex, p, wish) {
            return p;
        }
        for _ in 0..3 {
            let depth = wish - field.sample(p);
            if depth <= 0.0 {
                return p;
            }
            corrected_direction = unit(p + field.normal(p) * depth - start, corrected_direction);
            p = end(corrected_direction);
        }
        if field.sample(p) >= min_distance {
            return p;
        }
        // The start is outside, so the way along the normal is too, unless the skin folds over it.
        let normal = field.normal(start);
        let (mut low, mut high) = (0.0f32, 1.0f32);
        let at = |t: f32| end(unit(corrected_direction * (1.0 - t) + normal * t, normal));
        for _ in 0..BISECTIONS {
            let midpoint = 0.5 * (low + high);
            if field.sample(at(midpoint)) >= min_distance { high = midpoint } else { low = midpoint }
        }
        // Steps of the bisection would be visible, and would differ between mirror images.
        let [below, above] = [low, high].map(|t| field.sample(at(t)));
        let between =
            low + (high - low) * ((min_distance - below) / (above - below).max(1e-9)).clamp(0.0, 1.0);
        let best = [at(between), at(high), end(normal), end(transported), p];
        // Rounding may leave the first a little too deep.
        let deep = |p: &Vec3| field.sample(*p).min(min_distance - 1e-5);
        best.into_iter()
            .reduce(|best, other| if deep(&other) > deep(&best) { other } else { best })
            .unwrap_or(p)
    }
}

/// Returns the targets of held hair after some passes of FABRIK (Aristidou and Lasenby 2011), so that the vertex that
/// is held most reaches its target if the hair is long enough; and the falloff, 1 up to that vertex.
pub(super) fn fabrik_targets(
    guide: &[Vec3],
    mut target: Vec<Vec3>,
    (weight, near): (&[f32], &[f32]),
    lengths: &[f32],
) -> (Vec<Vec3>, Vec<f32>) {
    let heaviest = (1..guide.len()).fold(1, |best, i| if weight[i] >= weight[best] { i } else { best });
    let goal = target[heaviest];
    for _ in 0..PASSES {
        target[heaviest] = goal;
        for i in (1..heaviest).rev() {
            target[i] = target[i + 1] + unit(target[i] - target[i + 1], Vec3::Y) * lengths[i];
        }
        target[0] = guide[0];
        for i in 0..heaviest {
            target[i + 1] = target[i] + unit(target[i + 1] - target[i], Vec3::Y) * lengths[i];
        }
    }
    let near = near.iter().enumerate().map(|(i, near)| if i <= heaviest { 1.0 } else { *near });
    (target, near.collect())
}
