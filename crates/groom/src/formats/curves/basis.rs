//! Tessellation of curves into polylines.
//!
//! In every basis, a vertex of the polyline is a weighted mean of a few control points. One table of weights therefore
//! interpolates positions, widths and colors. Cubic segments are split at equal steps of their parameter, into about
//! [`VERTICES`] per strand.

/// Basis of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Basis<'a> {
    /// Straight segments between the points.
    Linear,
    /// Cubic Bézier segments that share their end points: 3 n + 1 points.
    Bezier,
    /// A uniform cubic B-spline. If `pinned`, it begins and ends at the outermost points.
    BSpline { pinned: bool },
    /// A Catmull-Rom curve, which interpolates its points. Unless `pinned`, it ends before the outermost points.
    CatmullRom { pinned: bool },
    /// A B-spline of degree below [`MAX_ORDER`] over its own knots, `points + order` of them.
    Knots { order: usize, knots: &'a [f32] },
}

/// Maximum control points of one vertex.
pub(crate) const MAX_ORDER: usize = 8;
/// Approximate number of vertices of a curved strand.
const VERTICES: usize = 32;

/// A vertex as weights of successive control points, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blend {
    first: usize,
    weights: [f32; MAX_ORDER],
    count: usize,
}

impl Blend {
    fn of(first: usize, some: &[f32]) -> Self {
        let mut weights = [0.0; MAX_ORDER];
        weights[..some.len()].copy_from_slice(some);
        Self { first, weights, count: some.len() }
    }

    /// Returns the weighted mean of a curve's values.
    pub fn of_values<T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>>(
        &self,
        values: &[T],
    ) -> T {
        let at = |k: usize| values[self.first + k];
        // A vertex with a single weight is bit-identical to that point.
        if let Some(k) = (0..self.count).find(|k| self.weights[*k] == 1.0) {
            return at(k);
        }
        (1..self.count).fold(at(0) * self.weights[0], |sum, k| sum + at(k) * self.weights[k])
    }
}

impl Basis<'_> {
    /// Returns the vertices of a curve of `points` points; an error says why the curve is invalid.
    pub fn vertices(&self, points: usize) -> Result<Vec<Blend>, String> {
        match self {
            Self::Linear => Ok((0..points).map(|i| Blend::of(i, &[1.0])).collect()),
            // A curve that is too short for its basis is straight, as in other readers.
            _ if points < 3 => Self::Linear.vertices(points),
            Self::Bezier => {
                if !(points - 1).is_multiple_of(3) {
                    return Err(format!("a Bézier curve has {points} points, but needs 3 n + 1"));
                }
                Ok(cut((points - 1) / 3, |segment, t| Blend::of(3 * segment, &bezier(t))))
            }
            Self::BSpline { pinned: true } => {
                Ok(cut(points - 1, |segment, t| mirrored(segment, points, b_spline(t))))
            }
            Self::CatmullRom { pinned: true } => {
                Ok(cut(points - 1, |segment, t| mirrored(segment, points, catmull_rom(t))))
            }
            Self::BSpline { .. } | Self::CatmullRom { .. } if points < 4 => {
                Err(format!("a cubic curve has {points} points, but needs 4 or more"))
            }
            Self::BSpline { .. } => Ok(cut(points - 3, |segment, t| Blend::of(segment, &b_spline(t)))),
            Self::CatmullRom { .. } => Ok(cut(points - 3, |segment, t| Blend::of(segment, &catmull_rom(t)))),
            Self::Knots { order, knots } => over_knots(points, *order, knots),
        }
    }
}

/// Samples `segments` segments at equal steps, both ends included.
fn cut(segments: usize, at: impl Fn(usize, f32) -> Blend) -> Vec<Blend> {
    let steps = (VERTICES - 1).div_ceil(segments).clamp(1, 8);
    let mut all: Vec<_> = (0..segments)
        .flat_map(|s| (0..steps).map(move |k| (s, k as f32 / steps as f32)))
        .map(|(s, t)| at(s, t))
        .collect();
    all.push(at(segments - 1, 1.0));
    all
}

/// Returns a vertex between points `segment` and `segment + 1` of a pinned curve, which is extended beyond its ends by
/// mirrored points, 2 p₀ − p₁.
fn mirrored(segment: usize, points: usize, [a, b, c, d]: [f32; 4]) -> Blend {
    match (segment == 0, segment + 2 == points) {
        (false, false) => Blend::of(segment - 1, &[a, b, c, d]),
        (true, false) => Blend::of(0, &[b + 2.0 * a, c - a, d]),
        (false, true) => Blend::of(segment - 1, &[a, b - d, c + 2.0 * d]),
        (true, true) => Blend::of(0, &[b + 2.0 * a - d, c - a + 2.0 * d]),
    }
}

fn bezier(t: f32) -> [f32; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

fn b_spline(t: f32) -> [f32; 4] {
    let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
    [s * s * s, 3.0 * t3 - 6.0 * t2 + 4.0, 3.0 * (t + t2 - t3) + 1.0, t3].map(|w| w / 6.0)
}

fn catmull_rom(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t2 - t - t3, 3.0 * t3 - 5.0 * t2 + 2.0, t + 4.0 * t2 - 3.0 * t3, t3 - t2].map(|w| 0.5 * w)
}

/// Tessellates a B-spline over its own knots, by the Cox–de Boor recursion for the nonzero basis functions (Piegl and
/// Tiller, *The NURBS Book*, algorithm A2.2).
fn over_knots(points: usize, order: usize, knots: &[f32]) -> Result<Vec<Blend>, String> {
    if !(2..=MAX_ORDER).contains(&order) {
        return Err(format!("a curve of order {order} is not supported, only orders 2 to {MAX_ORDER}"));
    }
    if points < order || knots.len() != points + order {
        return Err(format!(
            "a curve has {} knots for {points} points of order {order}, but needs {points} + {order}",
            knots.len()
        ));
    }
    if !knots.windows(2).all(|pair| pair[0] <= pair[1]) {
        return Err("the knots of a curve decrease".into());
    }
    let spans: Vec<usize> = (order - 1..points).filter(|k| knots[*k] < knots[k + 1]).collect();
    if spans.is_empty() {
        return Err("the knots of a curve are all equal".into());
    }
    Ok(cut(spans.len(), |span, t| {
        let k = spans[span];
        let u = knots[k] + (knots[k + 1] - knots[k]) * t;
        let (mut weights, mut left, mut right) =
            ([0.0f32; MAX_ORDER], [0.0f32; MAX_ORDER], [0.0f32; MAX_ORDER]);
        weights[0] = 1.0;
        for j in 1..order {
            left[j] = u - knots[k + 1 - j];
            right[j] = knots[k + j] - u;
            let mut saved = 0.0;
            for r in 0..j {
                let ratio = weights[r] / (right[r + 1] + left[j - r]);
                weights[r] = saved + right[r + 1] * ratio;
                saved = left[j - r] * ratio;
            }
            weights[j] = saved;
        }
        Blend::of(k + 1 - order, &weights[..order])
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const POINTS: [Vec3; 7] = [
        Vec3::new(0.0, 0.0, 0.0),
        Vec3::new(1.0, 2.0, 0.0),
        Vec3::new(2.0, 1.0, 1.0),
        Vec3::new(3.0, 3.0, 0.5),
        Vec3::new(4.0, 0.0, 1.0),
        Vec3::new(5.0, 1.0, 2.0),
        Vec3::new(6.0, 0.5, 0.0),
    ];

    fn curve(basis: Basis) -> Vec<Vec3> {
        basis.vertices(POINTS.len()).unwrap().iter().map(|blend| blend.of_values(&POINTS)).collect()
    }

    #[test]
    fn weights_sum_to_one_and_lines_stay_lines() {
        let clamped = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 4.0];
        let line: Vec<Vec3> = (0..7).map(|i| Vec3::new(1.0, 2.0, -1.0) * i as f32).collect();
        for basis in [
            Basis::Linear,
            Basis::Bezier,
            Basis::BSpline { pinned: true },
            Basis::BSpline { pinned: false },
            Basis::CatmullRom { pinned: true },
            Basis::CatmullRom { pinned: false },
            Basis::Knots { order: 4, knots: &clamped },
        ] {
            for blend in basis.vertices(7).unwrap() {
                let sum: f32 = blend.weights.iter().sum();
                assert!((sum - 1.0).abs() < 1e-5, "{basis:?}: {sum}");
                let p = blend.of_values(&line);
                assert!((p - Vec3::new(1.0, 2.0, -1.0) * p.x).length() < 1e-5, "{basis:?}: {p}");
            }
        }
    }

    #[test]
    fn curve_ends_match_basis() {
        let ends = |basis| {
            let all = curve(basis);
            (all[0], all[all.len() - 1])
        };
        let outermost = (POINTS[0], POINTS[6]);
        let close = |a: (Vec3, Vec3), b: (Vec3, Vec3)| a.0.distance(b.0) + a.1.distance(b.1) < 1e-5;
        assert_eq!(ends(Basis::Linear), outermost);
        assert_eq!(ends(Basis::Bezier), outermost);
        assert!(close(ends(Basis::BSpline { pinned: true }), outermost));
        assert!(close(ends(Basis::CatmullRom { pinned: true }), outermost));
        assert!(close(ends(Basis::CatmullRom { pinned: false }), (POINTS[1], POINTS[5])));
        let sixth = |a: usize, b: usize, c: usize| (POINTS[a] + 4.0 * POINTS[b] + POINTS[c]) / 6.0;
        let inner = (sixth(0, 1, 2), sixth(4, 5, 6));
        assert!(close(ends(Basis::BSpline { pinned: false }), inner));
        // The comparison detects a different end.
        assert!(!close(inner, outermost));
    }

    #[test]
    fn knots_reproduce_other_bases() {
        // Uniform knots give the uniform B-spline, triple knots the Bézier curve.
        let even: Vec<f32> = (0..11).map(|i| i as f32).collect();
        let bezier = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0];
        let line = [0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0];
        let pairs: [(&[f32], usize, Basis); 2] =
            [(&even, 4, Basis::BSpline { pinned: false }), (&bezier, 4, Basis::Bezier)];
        for (knots, order, same) in pairs {
            let (a, b) = (curve(Basis::Knots { order, knots }), curve(same));
            assert_eq!(a.len(), b.len());
            assert!(a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-5), "{same:?}");
            assert!(a.iter().zip(&b[1..]).any(|(a, b)| a.distance(*b) > 1e-2));
        }
        let straight = curve(Basis::Knots { order: 2, knots: &line });
        assert!(POINTS.iter().all(|p| straight.iter().any(|v| v.distance(*p) < 1e-5)));
    }

    #[test]
    fn invalid_curves_are_reported() {
        let says = |basis: Basis, points| basis.vertices(points).unwrap_err();
        assert!(says(Basis::Bezier, 6).contains("3 n + 1"));
        assert!(says(Basis::CatmullRom { pinned: false }, 3).contains("needs 4"));
        assert!(says(Basis::Knots { order: 9, knots: &[] }, 20).contains("order 9"));
        assert!(says(Basis::Knots { order: 4, knots: &[0.0; 7] }, 4).contains("knots for 4"));
        assert!(says(Basis::Knots { order: 4, knots: &[0.0; 8] }, 4).contains("equal"));
        assert!(
            says(Basis::Knots { order: 2, knots: &[0.0, f32::NAN, 1.0, 2.0, 3.0] }, 3).contains("decrease")
        );
        assert_eq!(Basis::Bezier.vertices(2).unwrap().len(), 2);
        assert!(Basis::Linear.vertices(0).unwrap().is_empty());
    }
}
