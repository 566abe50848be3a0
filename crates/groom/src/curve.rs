//! Resampling of polylines.

use glam::Vec3;

/// Returns the length of a polyline, meters.
pub fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Returns the points at ascending `distances` along the polyline `points`.
fn walk(points: &[Vec3], distances: impl Iterator<Item = f32>) -> Vec<Vec3> {
    let mut segment = 0;
    let mut passed = 0.0;
    let mut segment_length = points[0].distance(points[1.min(points.len() - 1)]);
    distances
        .map(|distance| {
            while segment + 2 < points.len() && passed + segment_length < distance {
                passed += segment_length;
                segment += 1;
                segment_length = points[segment].distance(points[segment + 1]);
            }
            let next = points[(segment + 1).min(points.len() - 1)];
            let t = if segment_length > 0.0 {
                ((distance - passed) / segment_length).clamp(0.0, 1.0)
            } else {
                0.0
            };
            points[segment].lerp(next, t)
        })
        .collect()
}

/// Returns `count` points (at least 2) at equal steps of arc length along the polyline `points`. Both ends are exact.
pub fn resample_chords(points: &[Vec3], count: usize) -> Vec<Vec3> {
    let Some(last) = points.last() else { return Vec::new() };
    let total = length(points);
    let mut resampled = walk(points, (0..count).map(|i| total * i as f32 / (count - 1) as f32));
    resampled[count - 1] = *last;
    resampled
}

/// Returns `count` points (at least 2) at equal steps of arc length along the smooth curve through `points`. Both ends
/// are exact.
pub fn resample(points: &[Vec3], count: usize) -> Vec<Vec3> {
    // Fine enough that the polyline deviates from the curve by a fraction of a percent of a segment.
    let fine = if points.len() > 2 && points.len() < 4 * count {
        subdivide(points, (4 * count).div_ceil(points.len() - 1) * (points.len() - 1) + 1)
    } else {
        points.to_vec()
    };
    resample_chords(&fine, count)
}

/// Returns the point at `x` segments from the start of the uniform cubic B-spline with the control points `points` (at
/// least 2). Phantom points make it start and end at the ends of the polyline. The shaders of `tresses` compute alike
/// (`tessellate/walk.wesl`).
pub fn spline_at(points: &[Vec3], x: f32) -> Vec3 {
    let last = points.len() - 1;
    let k = (x as usize).min(last - 1);
    let (u, start, end) = ((x - k as f32).min(1.0), points[k], points[k + 1]);
    let s = 1.0 - u;
    let before = if k > 0 { points[k - 1] } else { 2.0 * start - end };
    let after = if k + 1 < last { points[k + 2] } else { 2.0 * end - start };
    (s * s * s * before
        + (4.0 - 3.0 * u * u * (1.0 + s)) * start
        + (4.0 - 3.0 * s * s * (1.0 + u)) * end
        + u * u * u * after)
        / 6.0
}

/// Returns `count` points (at least 2) at equal parameter steps of the Catmull-Rom spline through `points` (at least
/// 2). If `count - 1` is a multiple of the number of segments, the result contains every one of `points`.
pub fn subdivide(points: &[Vec3], count: usize) -> Vec<Vec3> {
    let last = points.len() - 1;
    let at = |i: isize| match i {
        -1 => 2.0 * points[0] - points[1],
        i if i as usize > last => 2.0 * points[last] - points[last - 1],
        i => points[i as usize],
    };
    (0..count)
        .map(|j| {
            let (segment, part) = ((j * last) / (count - 1), (j * last) % (count - 1));
            if part == 0 {
                return points[segment];
            }
            let t = part as f32 / (count - 1) as f32;
            let k = segment as isize;
            let (p0, p1, p2, p3) = (at(k - 1), at(k), at(k + 1), at(k + 2));
            // Centripetal knots: no loops or overshoots between segments of different length.
            let parameter_step = |a: Vec3, b: Vec3| a.distance(b).sqrt().max(1e-6);
            let (d0, d1, d2) = (parameter_step(p0, p1), parameter_step(p1, p2), parameter_step(p2, p3));
            let m1 = (p2 - p1) + d1 * ((p1 - p0) / d0 - (p2 - p0) / (d0 + d1));
            let m2 = (p2 - p1) + d1 * ((p3 - p2) / d2 - (p3 - p1) / (d1 + d2));
            let (t2, t3) = (t * t, t * t * t);
            (2.0 * t3 - 3.0 * t2 + 1.0) * p1
                + (t3 - 2.0 * t2 + t) * m1
                + (3.0 * t2 - 2.0 * t3) * p2
                + (t3 - t2) * m2
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn helix(count: usize) -> Vec<Vec3> {
        (0..count)
            .map(|i| {
                let t = i as f32 / (count - 1) as f32 * 6.0;
                Vec3::new(t.cos(), -0.5 * t, t.sin()) * 0.02
            })
            .collect()
    }

    #[test]
    fn subdivision_keeps_the_vertices() {
        let points = helix(16);
        let fine = subdivide(&points, 31);
        for (i, p) in points.iter().enumerate() {
            assert_eq!(fine[2 * i], *p);
        }
        // Between the vertices, the spline stays close to the helix.
        let truth = helix(31);
        let error =
            |curve: &[Vec3]| curve.iter().zip(&truth).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(error(&fine) < 5e-4, "{}", error(&fine));
    }

    #[test]
    fn resampling_is_even_and_keeps_the_ends() {
        let mut points = helix(40);
        points.drain(5..12);
        let even = resample(&points, 32);
        assert_eq!((even[0], even[31]), (points[0], points[39 - 7]));
        let steps: Vec<_> = even.windows(2).map(|w| w[0].distance(w[1])).collect();
        let mean = steps.iter().sum::<f32>() / 31.0;
        assert!(steps.iter().all(|s| (s / mean - 1.0).abs() < 0.03), "{steps:?}");
    }

    #[test]
    fn chords_are_resampled_at_equal_steps() {
        let source: Vec<_> = (0..37).map(|i| Vec3::new((i * i) as f32 * 1e-3, 0.1, 0.3)).collect();
        let out = resample_chords(&source, 16);
        assert_eq!((out[0], out[15]), (source[0], source[36]));
        let step = source[36].distance(source[0]) / 15.0;
        assert!(out.windows(2).all(|w| (w[0].distance(w[1]) - step).abs() < 1e-5));
        assert!(resample_chords(&[], 8).is_empty());
        assert_eq!(resample_chords(&[Vec3::X], 3), [Vec3::X; 3]);
    }

    #[test]
    fn degenerate_polylines_stay_finite() {
        for points in [vec![Vec3::X, Vec3::X], vec![Vec3::X, Vec3::X, Vec3::X], vec![Vec3::X, Vec3::Y]] {
            assert!(resample(&points, 8).iter().chain(&subdivide(&points, 9)).all(|p| p.is_finite()));
        }
    }
}
