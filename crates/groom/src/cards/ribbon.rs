//! Ribbons: curved strips fitted to locks of strands.

use super::{lines::Lines, volume::HairVolume};
use crate::curve;
use glam::{Mat3, Vec2, Vec3};
use std::f32::consts::PI;

/// Rows of a ribbon, root and tip included.
pub(super) const ROWS: usize = 25;

/// Weight of the preference for ribbons that face outwards against the shape of the lock.
const FACING: f32 = 0.25;
/// Fraction of the strands' points that the width contains on either side.
const INSIDE: f32 = 0.98;
/// Fractions of the roots and tips that the length contains.
const ROOTS: f32 = 0.995;
const TIPS: f32 = 0.98;
/// Least half width, meters.
const MIN_HALF_WIDTH: f32 = 0.0005;
/// Fraction of the depth's standard deviation by which the ribbon lies outside the middle of its lock: outer strands
/// make the silhouette.
const OUTSIDE: f32 = 0.7;
/// Largest twist, radians per meter.
const TWIST: f32 = 36.0 * PI / 180.0 / 0.01;

/// A cross-section of a ribbon.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row {
    /// Point of the lock's middle line.
    pub(super) center: Vec3,
    /// Unit vectors: along the lock, across it, and out of its face.
    pub(super) along: Vec3,
    pub(super) side: Vec3,
    pub(super) out: Vec3,
    /// Half the width, and the offset of the middle of the width, meters.
    pub(super) half: f32,
    pub(super) shift: f32,
    /// Height over the plane of `center`, `side` and `along` as a polynomial of the position across (-1..1), meters.
    pub(super) bend: [f32; 3],
    /// Standard deviation of the strands' distances from that height, meters.
    pub(super) spread: f32,
}

impl Row {
    fn mixed(&self, other: &Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        let along = self.along.lerp(other.along, t).normalize_or(self.along);
        let side = self.side.lerp(other.side, t).reject_from(along).normalize_or(self.side);
        Self {
            center: self.center.lerp(other.center, t),
            along,
            side,
            out: along.cross(side),
            half: mix(self.half, other.half),
            shift: mix(self.shift, other.shift),
            bend: std::array::from_fn(|k| mix(self.bend[k], other.bend[k])),
            spread: mix(self.spread, other.spread),
        }
    }

    /// Returns the height of the ribbon at `across`, -1 to 1.
    pub(super) fn height(&self, across: f32) -> f32 {
        self.bend[0] + across * (self.bend[1] + across * self.bend[2])
    }

    /// Returns the point of the ribbon at `across`, -1 to 1.
    pub(super) fn point(&self, across: f32) -> Vec3 {
        let height = self.height(across) + OUTSIDE * self.spread;
        self.center + self.side * (self.shift + across * self.half) + self.out * height
    }
}

/// A strip fitted to a lock of strands.
#[derive(Clone, Debug)]
pub(super) struct Ribbon {
    rows: Vec<Row>,
    /// Length of the middle line, meters.
    pub(super) length: f32,
}

/// A point in the frame of a ribbon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flat {
    /// Position across, -1 to 1 on the ribbon, and along, 0 (root) to 1 (tip).
    pub(super) at: Vec2,
    /// Height over the ribbon, meters.
    pub(super) depth: f32,
}

/// Weighted sums for the fit of a row's height.
#[derive(Clone, Copy, Default)]
struct Moments {
    /// Sums of the weight times powers of the position across.
    powers: [f64; 5],
    /// The same times the height.
    heights: [f64; 3],
    square: f64,
}

impl Moments {
    fn add(&mut self, weight: f32, across: f32, height: f32) {
        let (mut product, across, height) = (f64::from(weight), f64::from(across), f64::from(height));
        self.square += product * height * height;
        for k in 0..5 {
            self.powers[k] += product;
            if k < 3 {
                self.heights[k] += product * height;
            }
            product *= across;
        }
    }

    fn scaled_add(&mut self, other: &Self, scale: f64) {
        self.powers.iter_mut().zip(other.powers).for_each(|(sum, x)| *sum += scale * x);
        self.heights.iter_mut().zip(other.heights).for_each(|(sum, x)| *sum += scale * x);
        self.square += scale * other.square;
    }

    /// Returns the polynomial of least squares and the standard deviation from it.
    fn solve(&self) -> ([f32; 3], f32) {
        let total = self.powers[0];
        if total <= 0.0 {
            return ([0.0; 3], 0.0);
        }
        let p = |k: usize| (self.powers[k] / total) as f32;
        // A little weight keeps the slope and the bend of few strands at zero.
        const PRIOR: f32 = 0.02;
        let matrix =
            Mat3::from_cols_array(&[p(0), p(1), p(2), p(1), p(2) + PRIOR, p(3), p(2), p(3), p(4) + PRIOR]);
        let right = Vec3::from_array(self.heights.map(|sum| (sum / total) as f32));
        let found = matrix.inverse() * right;
        let left = (self.square / total) as f32 - found.dot(right);
        if found.is_finite() { (found.to_array(), left.max(0.0).sqrt()) } else { ([right.x, 0.0, 0.0], 0.0) }
    }
}

/// Returns the weights of the rows around row `k` in a bell of standard deviation `breadth` rows.
fn bell(k: usize, breadth: f32) -> impl Iterator<Item = (usize, f32)> {
    (0..ROWS).map(move |j| (j, (-0.5 * ((j as f32 - k as f32) / breadth).powi(2)).exp()))
}

/// Returns the value below which the `fraction` of the weight of `values` lies.
fn percentile(values: &mut [(f32, f32)], fraction: f32) -> f32 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = fraction * values.iter().map(|(_, weight)| weight).sum::<f32>();
    for (value, weight) in values.iter() {
        left -= weight;
        if left <= 0.0 {
            return *value;
        }
    }
    values.last().map_or(0.0, |(value, _)| *value)
}

impl Ribbon {
    /// Fits a ribbon to the strands `members`.
    pub(super) fn fit(lines: &Lines<'_>, members: &[u32], volume: &HairVolume<'_>) -> Self {
        let mut ribbon = Self::mean_line(lines, members);
        (0..2).for_each(|_| ribbon.refine(lines, members));
        ribbon.face(lines, members, volume);
        ribbon.widen(lines, members);
        ribbon
    }

    /// Returns the mean line of the members, with their mean length.
    fn mean_line(lines: &Lines<'_>, members: &[u32]) -> Self {
        let total: f32 = members.iter().map(|i| lines.weights[*i as usize]).sum();
        let mean = |k: usize| {
            let sum =
                members.iter().map(|i| lines.weights[*i as usize] * lines.path_points(*i)[k]).sum::<Vec3>();
            sum / total
        };
        let points: Vec<_> = (0..super::lines::PATH_POINTS).map(mean).collect();
        let target_length =
            members.iter().map(|i| lines.weights[*i as usize] * lines.length(*i)).sum::<f32>() / total;
        let scale = (target_length / curve::length(&points).max(1e-9)).clamp(1.0, 1.5);
        let mut at = points[0];
        let stretched: Vec<_> = std::iter::once(at)
            .chain(points.windows(2).map(|edge| {
                at += scale * (edge[1] - edge[0]);
                at
            }))
            .collect();
        Self::along(&stretched)
    }

    /// Returns a ribbon without width along `points`.
    fn along(points: &[Vec3]) -> Self {
        let length = curve::length(points).max(1e-6);
        let even = curve::resample_chords(points, ROWS);
        let row = |k: usize| {
            let delta = even[(k + 1).min(ROWS - 1)] - even[k.saturating_sub(1)];
            let along = delta.normalize_or(Vec3::NEG_Y);
            let side = along.any_orthonormal_vector();
            Row { center: even[k], along, side, out: along.cross(side), ..Row::default() }
        };
        Self { rows: (0..ROWS).map(row).collect(), length }
    }

    /// Moves the line to the middle of the strands beside each row, from the first roots to the last tips. Strands have
    /// roots and tips at different places along a lock.
    fn refine(&mut self, lines: &Lines<'_>, members: &[u32]) {
        const STEPS: usize = 32;
        let mut points = Vec::with_capacity(members.len() * (STEPS + 1));
        let (mut roots, mut tips) = (Vec::new(), Vec::new());
        for i in members {
            let weight = lines.weights[*i as usize];
            let mut guess = 0.0;
            for (step, p) in lines.path(*i, STEPS + 1).enumerate() {
                guess = self.closest_fraction(p, guess);
                points.push((guess, p, weight));
                match step {
                    0 => roots.push((guess, weight)),
                    STEPS => tips.push((guess, weight)),
                    _ => {}
                }
            }
        }
        let begin = percentile(&mut roots, 1.0 - ROOTS).clamp(-0.5, 0.3);
        let end = percentile(&mut tips, TIPS).clamp(0.5, 1.5);
        let step = (end - begin) / (ROWS - 1) as f32;
        let breadth = 0.7 * step;
        let mut sums = [(Vec3::ZERO, 0.0f32, 0.0f32); ROWS];
        for (v, p, weight) in points {
            let x = (v - begin) / step;
            for k in (x.floor() as isize - 1)..=(x.floor() as isize + 2) {
                if let Some((sum, fraction_sum, total)) =
                    usize::try_from(k).ok().and_then(|k| sums.get_mut(k))
                {
                    let off = (x - k as f32) * step / breadth;
                    let weight = weight * (-0.5 * off * off).exp();
                    *sum += weight * p;
                    *fraction_sum += weight * v;
                    *total += weight;
                }
            }
        }
        let means: Vec<(Vec3, f32)> = sums
            .iter()
            .filter(|(.., total)| *total > 0.0)
            .map(|(sum, v, total)| (*sum / *total, v / total))
            .collect();
        let last = means.len() as isize - 1;
        if last < 1 {
            return;
        }
        // The middle jumps where strands begin and end. Beyond its ends, the line continues as its point reflection.
        let get = |k: isize| match k {
            k if k < 0 => 2.0 * means[0].0 - means[(-k).min(last) as usize].0,
            k if k > last => 2.0 * means[last as usize].0 - means[(2 * last - k).max(0) as usize].0,
            k => means[k as usize].0,
        };
        let mut points: Vec<Vec3> = (0..=last)
            .map(|k| 0.5 * get(k) + 0.2 * (get(k - 1) + get(k + 1)) + 0.05 * (get(k - 2) + get(k + 2)))
            .collect();
        // The means at the ends are of points inside: lengthen the line to the roots and tips.
        let extend =
            |end: Vec3, next: Vec3, far: f32| end + (end - next).normalize_or_zero() * (far * self.length);
        let first = extend(points[0], points[1], means[0].1 - begin);
        let tip = extend(points[last as usize], points[last as usize - 1], end - means[last as usize].1);
        points.insert(0, first);
        points.push(tip);
        if points.len() > 1 && curve::length(&points) > 1e-5 {
            *self = Self::along(&points);
        }
    }

    /// Turns the rows: across the lock where it is widest, and out of the hair.
    fn face(&mut self, lines: &Lines<'_>, members: &[u32], volume: &HairVolume<'_>) {
        let mut shapes = vec![Mat3::ZERO; ROWS];
        for i in members {
            let weight = lines.weights[*i as usize];
            let mut guess = 0.0;
            for p in lines.path(*i, ROWS) {
                let v = self.closest_fraction(p, guess).clamp(0.0, 1.0);
                guess = v;
                let x = v * (ROWS - 1) as f32;
                let low = (x as usize).min(ROWS - 2);
                let off = p - self.row(v).center;
                let outer = Mat3::from_cols(off * off.x, off * off.y, off * off.z) * weight;
                shapes[low] += outer * (low as f32 + 1.0 - x);
                shapes[low + 1] += outer * (x - low as f32);
            }
        }
        let outs: Vec<Vec3> = self.rows.iter().map(|row| volume.outward(row.center)).collect();
        // A frame without twist, in which the angles are smooth.
        let mut frames = Vec::with_capacity(ROWS);
        let mut side = self.rows[0].along.any_orthonormal_vector();
        for row in &self.rows {
            side = side.reject_from(row.along).normalize_or(row.along.any_orthonormal_vector());
            frames.push((side, row.along.cross(side)));
        }
        let mut tensors = Vec::with_capacity(ROWS);
        for (k, (a, b)) in frames.iter().enumerate() {
            let (mut shape, mut out) = (Mat3::ZERO, Vec3::ZERO);
            for (j, weight) in bell(k, ROWS as f32 / 8.0) {
                shape += shapes[j] * weight;
                out += outs[j] * weight;
            }
            let trace = shape.x_axis.x + shape.y_axis.y + shape.z_axis.z;
            let shape = if trace > 1e-12 { shape * (1.0 / trace) } else { Mat3::ZERO };
            let out = out.normalize_or_zero();
            let form = |u: Vec3, v: Vec3| u.dot(shape * v) + FACING * (u.dot(v) - u.dot(out) * v.dot(out));
            tensors.push((form(*a, *b), 0.5 * (form(*a, *a) - form(*b, *b)), out));
        }
        let mut angle = None;
        let max_twist = TWIST * self.length / (ROWS - 1) as f32;
        for ((row, (a, b)), (cross, difference, _)) in self.rows.iter_mut().zip(&frames).zip(&tensors) {
            let found = 0.5 * cross.atan2(*difference);
            let next = match angle {
                None => found,
                // The axis has no sign: take the nearest of the two.
                Some(last) => {
                    let change: f32 = found - last;
                    last + (change - PI * (change / PI).round()).clamp(-max_twist, max_twist)
                }
            };
            angle = Some(next);
            let (sin, cos) = next.sin_cos();
            row.side = *a * cos + *b * sin;
            row.out = row.along.cross(row.side);
        }
        let facing: f32 = self.rows.iter().zip(&tensors).map(|(row, (.., out))| row.out.dot(*out)).sum();
        if facing < 0.0 {
            self.rows.iter_mut().for_each(|row| (row.side, row.out) = (-row.side, -row.out));
        }
    }

    /// Measures width, bend and depth.
    fn widen(&mut self, lines: &Lines<'_>, members: &[u32]) {
        let mut points = vec![Vec::new(); ROWS];
        for i in members {
            let (strand, radii) = lines.strand(*i);
            let weight = lines.weights[*i as usize] / strand.len() as f32;
            for (k, (p, radius)) in strand.iter().zip(radii).enumerate() {
                let v =
                    self.closest_fraction(*p, k as f32 / (strand.len() - 1).max(1) as f32).clamp(0.0, 1.0);
                let row = self.row(v);
                let off = *p - row.center;
                let x = (v * (ROWS - 1) as f32).round() as usize;
                points[x].push((off.dot(row.side), off.dot(row.out), weight, *radius));
            }
        }
        let edges: Vec<_> = (0..ROWS)
            .map(|k| {
                let near = points[k.saturating_sub(1)..(k + 2).min(ROWS)].iter().flatten();
                let side =
                    |sign: f32| near.clone().map(move |(u, _, w, r)| (sign * u + r, *w)).collect::<Vec<_>>();
                let edge = |sign| percentile(&mut side(sign), INSIDE);
                (near.clone().next().is_some()).then(|| [edge(-1.0), edge(1.0)])
            })
            .collect();
        for k in 0..ROWS {
            let (mut sum, mut total) = ([0.0; 2], 0.0);
            for (j, weight) in bell(k, 1.2) {
                if let Some(edges) = edges[j] {
                    sum = [sum[0] + weight * edges[0], sum[1] + weight * edges[1]];
                    total += weight;
                }
            }
            let [left, right] = sum.map(|sum| sum / f32::max(total, 1e-9));
            let row = &mut self.rows[k];
            row.half = (0.5 * (left + right)).max(MIN_HALF_WIDTH);
            row.shift = 0.5 * (right - left);
        }
        let mut moments = vec![Moments::default(); ROWS];
        for ((moments, points), row) in moments.iter_mut().zip(&points).zip(&self.rows) {
            for (u, r, weight, _) in points {
                moments.add(*weight, ((u - row.shift) / row.half).clamp(-1.0, 1.0), *r);
            }
        }
        for k in 0..ROWS {
            let mut sum = Moments::default();
            bell(k, 2.0).for_each(|(j, weight)| sum.scaled_add(&moments[j], f64::from(weight)));
            let row = &mut self.rows[k];
            (row.bend, row.spread) = sum.solve();
        }
    }

    /// Returns the row at `v`, 0 (root) to 1 (tip).
    pub(super) fn row(&self, v: f32) -> Row {
        let x = v.clamp(0.0, 1.0) * (ROWS - 1) as f32;
        let low = (x as usize).min(ROWS - 2);
        self.rows[low].mixed(&self.rows[low + 1], x - low as f32)
    }

    /// Returns the fraction of the length at which the line is nearest to `p`, below 0 or above 1 beyond its ends.
    /// `guess` is close to it.
    fn closest_fraction(&self, p: Vec3, guess: f32) -> f32 {
        let mut v = guess;
        for _ in 0..4 {
            let row = self.row(v);
            let excess = v - v.clamp(0.0, 1.0);
            let center = row.center + row.along * (excess * self.length);
            v = (v + ((p - center).dot(row.along) / self.length).clamp(-0.2, 0.2)).clamp(-0.5, 2.0);
        }
        v
    }

    /// Returns `p` in the frame of the ribbon. `guess` is close to its position along.
    pub(super) fn flat(&self, p: Vec3, guess: f32) -> Flat {
        let v = self.closest_fraction(p, guess);
        let row = self.row(v);
        let off = p - row.center;
        let across = (off.dot(row.side) - row.shift) / row.half;
        let depth = off.dot(row.out) - row.height(across.clamp(-1.0, 1.0));
        Flat { at: Vec2::new(across, v), depth }
    }

    /// Mean half width, meters.
    pub(super) fn half(&self) -> f32 {
        self.rows.iter().map(|row| row.half).sum::<f32>() / ROWS as f32
    }

    /// Largest half width, meters.
    pub(super) fn widest(&self) -> f32 {
        self.rows.iter().map(|row| row.half).fold(0.0, f32::max)
    }
}
