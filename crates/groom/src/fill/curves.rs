//! Decomposition of the input strands into a smooth path and the detail around it.
//!
//! The mean of two curls is no curl. Interpolation therefore blends only the *path*: the strand smoothed over a little
//! less than half a turn of its curl, or over a tenth of its length if it has no curls. The remainder, the *detail*, is
//! copied unchanged from one strand to another. A path ends where its strand ends, so path plus detail is the strand.

use crate::{SdfGrid, Strands, curve};
use glam::{Quat, Vec3};

/// Even steps along a strand for smoothing.
const STEPS: usize = 32;

/// Points of each path for comparing strands, root and tip included.
pub(crate) const PATH_POINTS: usize = 9;

/// Standard deviation of the Gaussian smoothing kernel, in turns of the curl. 0.45 leaves 2% of the curl.
const BREADTH: f32 = 0.45;

/// Border between path and detail.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smoothing {
    /// Standard deviation of the kernel for strands without curls, as a fraction of the length.
    pub(crate) plain: f32,
    /// Turns from which on waves are curls, which are no part of the path.
    pub(crate) turns: f32,
}

impl Smoothing {
    /// Paths that can be mixed.
    pub(crate) const STRONG: Self = Self { plain: 0.1, turns: 1.5 };
    /// Paths close to their strands.
    #[cfg(feature = "cards")]
    pub(crate) const WEAK: Self = Self { plain: 0.02, turns: 3.0 };
}

/// Mean squared slope above which a strand counts as curly.
const SLOPE: f32 = 0.02;

/// Paths and details of the input strands. Per-vertex arrays have the strands' vertex indices.
pub(crate) struct Curves {
    pub(crate) offsets: Vec<u32>,
    /// Fraction of the strand's length at each vertex.
    pub(crate) along: Vec<f32>,
    pub(crate) path: Vec<Vec3>,
    pub(crate) detail: Vec<Vec3>,
    /// Rotation of the path since the root, accumulated from the smallest rotation between edges.
    pub(crate) rotation: Vec<Quat>,
    /// Length of each strand, meters.
    pub(crate) length: Vec<f32>,
    /// Path points at equal fractions of the length, `PATH_POINTS` per strand.
    pub(crate) path_points: Vec<Vec3>,
    /// Distance of each knot from the head, meters; empty without a head.
    pub(crate) clear: Vec<f32>,
}

impl Curves {
    pub(crate) fn new(strands: &Strands, field: Option<&SdfGrid>, smoothing: Smoothing) -> Self {
        let mut curves = Self {
            offsets: strands.offsets.clone(),
            along: Vec::with_capacity(strands.positions.len()),
            path: Vec::with_capacity(strands.positions.len()),
            detail: Vec::with_capacity(strands.positions.len()),
            rotation: Vec::with_capacity(strands.positions.len()),
            length: Vec::with_capacity(strands.len()),
            path_points: Vec::with_capacity(strands.len() * PATH_POINTS),
            clear: Vec::new(),
        };
        let mut path = Vec::new();
        for strand in strands.iter() {
            let even = curve::resample_chords(strand, STEPS + 1);
            let length = curve::length(strand).max(1e-9);
            smooth(&even, breadth(&even, length, smoothing), &mut path);
            let mut passed = 0.0;
            let (mut rotation, mut last) = (Quat::IDENTITY, Vec3::ZERO);
            for (k, &p) in strand.iter().enumerate() {
                if k > 0 {
                    passed += strand[k - 1].distance(p);
                }
                let s = (passed / length).min(1.0);
                let on = at(&path, s);
                let edge =
                    (at(&path, (s + 0.02).min(1.0)) - at(&path, (s - 0.02).max(0.0))).normalize_or(last);
                if k > 0 {
                    rotation = (Quat::from_rotation_arc(last, edge) * rotation).normalize();
                }
                last = edge.normalize_or(Vec3::Y);
                curves.along.push(s);
                curves.path.push(on);
                curves.detail.push(p - on);
                curves.rotation.push(rotation);
            }
            curves.length.push(length);
            curves
                .path_points
                .extend((0..PATH_POINTS).map(|k| at(&path, k as f32 / (PATH_POINTS - 1) as f32)));
        }
        if let Some(field) = field {
            curves.clear = curves.path_points.iter().map(|p| field.sample(*p)).collect();
        }
        curves
    }

    /// Returns the vertex range of strand `i`.
    pub(crate) fn range(&self, i: u32) -> std::ops::Range<usize> {
        self.offsets[i as usize] as usize..self.offsets[i as usize + 1] as usize
    }

    pub(crate) fn path_points(&self, i: u32) -> &[Vec3] {
        &self.path_points[i as usize * PATH_POINTS..(i as usize + 1) * PATH_POINTS]
    }

    /// Returns the point on the path of strand `i` at the fraction `s` of its length. `from` is a cursor for calls with
    /// ascending `s`; it starts at 0.
    pub(crate) fn path_at(&self, i: u32, s: f32, from: &mut usize) -> Vec3 {
        let range = self.range(i);
        let along = &self.along[range.clone()];
        while *from + 2 < along.len() && along[*from + 1] < s {
            *from += 1;
        }
        let (a, b) = (along[*from], along[*from + 1]);
        let t = if b > a { ((s - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        self.path[range.start + *from].lerp(self.path[range.start + *from + 1], t)
    }
}

/// Samples a polyline of even steps at the fraction `s`.
fn at(even: &[Vec3], s: f32) -> Vec3 {
    let x = s * (even.len() - 1) as f32;
    let i = (x as usize).min(even.len() - 2);
    even[i].lerp(even[i + 1], x - i as f32)
}

/// Returns the standard deviation of the smoothing kernel, as a fraction of the length.
fn breadth(even: &[Vec3], length: f32, smoothing: Smoothing) -> f32 {
    // Remove the quadratic trend of the directions, which is the fall or an overall wave, so that the curl remains.
    let mut slopes = [Vec3::ZERO; STEPS];
    for (slope, w) in slopes.iter_mut().zip(even.windows(2)) {
        *slope = (w[1] - w[0]) * (STEPS as f32 / length);
    }
    let x = |k: usize| (2.0 * k as f32 + 1.0) / STEPS as f32 - 1.0;
    // Legendre polynomials; the means of their squares are 1, 1/3 and 1/5.
    let basis: [fn(f32) -> f32; 3] = [|_| 1.0, |x| x, |x| 1.5 * x * x - 0.5];
    for (p, mean) in basis.iter().zip([1.0, 3.0, 5.0]) {
        let part: Vec3 = (0..STEPS).map(|k| slopes[k] * p(x(k))).sum::<Vec3>() * (mean / STEPS as f32);
        for (k, slope) in slopes.iter_mut().enumerate() {
            *slope -= part * p(x(k));
        }
    }
    let energy = slopes.iter().map(|s| s.length_squared()).sum::<f32>() / STEPS as f32;
    if energy < SLOPE {
        return smoothing.plain;
    }
    // The number of turns is the peak of the spectrum of the directions.
    let power = |turns: f32| -> f32 {
        let (mut re, mut im) = (Vec3::ZERO, Vec3::ZERO);
        for (k, slope) in slopes.iter().enumerate() {
            let (sin, cos) = (turns * std::f32::consts::TAU * (k as f32 + 0.5) / STEPS as f32).sin_cos();
            re += *slope * cos;
            im += *slope * sin;
        }
        re.length_squared() + im.length_squared()
    };
    let turns = (3..=24).map(|k| 0.5 * k as f32).map(|turns| (power(turns), turns));
    let (_, turns) = turns.fold((0.0, 3.0), |best, at| if at.0 > best.0 { at } else { best });
    if turns < smoothing.turns {
        return smoothing.plain;
    }
    (BREADTH / turns).max(0.5 * smoothing.plain)
}

/// Smooths `even` with a Gaussian kernel and keeps its ends fixed: beyond each end, the line continues as its point
/// reflection.
fn smooth(even: &[Vec3], breadth: f32, out: &mut Vec<Vec3>) {
    let n = even.len() as isize - 1;
    let deviation = breadth * n as f32;
    let radius = ((3.0 * deviation).ceil() as isize).min(n);
    let weight = |d: isize| (-0.5 * (d as f32 / deviation).powi(2)).exp();
    let weights: Vec<f32> = (0..=radius).map(weight).collect();
    let total = weights[0] + 2.0 * weights[1..].iter().sum::<f32>();
    let get = |i: isize| match i {
        i if i < 0 => 2.0 * even[0] - even[(-i) as usize],
        i if i > n => 2.0 * even[n as usize] - even[(2 * n - i) as usize],
        i => even[i as usize],
    };
    out.clear();
    out.extend((0..=n).map(|i| {
        (1..=radius).fold(weights[0] * get(i), |sum, d| sum + weights[d as usize] * (get(i - d) + get(i + d)))
            / total
    }));
    // The ends are exact except for rounding.
    out[0] = even[0];
    out[n as usize] = even[n as usize];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strand with `turns` turns of radius `radius` around a falling path.
    fn helix(turns: f32, radius: f32) -> Vec<Vec3> {
        (0..64)
            .map(|k| {
                let s = k as f32 / 63.0;
                let (sin, cos) = (turns * std::f32::consts::TAU * s).sin_cos();
                Vec3::new(radius * cos + 0.05 * s * s, -0.2 * s, radius * sin)
            })
            .collect()
    }

    #[test]
    fn paths_are_smooth_and_details_hold_the_curls() {
        let mut strands = Strands::default();
        for turns in [2.0, 4.0, 7.0] {
            strands.push(&helix(turns, 0.006));
        }
        strands.push(&helix(0.0, 0.0));
        let curves = Curves::new(&strands, None, Smoothing::STRONG);
        for i in 0..4 {
            let range = curves.range(i);
            for v in range.clone() {
                let sum = curves.path[v] + curves.detail[v];
                assert!(sum.distance(strands.positions[v]) < 1e-6);
            }
            let middle = &curves.detail[range.start + 20..range.end - 20];
            let radius =
                (middle.iter().map(|d| d.length_squared()).sum::<f32>() / middle.len() as f32).sqrt();
            let expected = if i == 3 { 0.0 } else { 0.006 };
            assert!((radius - expected).abs() < 6e-4, "strand {i}: {radius}");
        }
    }
}
