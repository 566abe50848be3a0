//! Samples that thin strips cover.

use glam::Vec2;

/// Most samples along one strip.
const LONGEST: f32 = 16_384.0;

/// The part of a strip in one column of samples, or in one row if the strip is steep.
struct Slice {
    /// Fraction of the way from the first end.
    t: f32,
    /// Middle and half of the extent, samples.
    center: f32,
    half_extent: f32,
    /// Index of the column's first sample, and the step to its next one.
    first: usize,
    step: usize,
    /// Samples in the column.
    count: usize,
}

/// Calls `visit` for each column of samples between the ends of a strip.
fn slices([a, b]: [Vec2; 2], half: [f32; 2], [width, height]: [usize; 2], mut visit: impl FnMut(Slice)) {
    let delta = b - a;
    let steep = delta.y.abs() > delta.x.abs();
    let swap_if_steep = |p: Vec2| if steep { Vec2::new(p.y, p.x) } else { p };
    let (mut low, mut high) = (swap_if_steep(a), swap_if_steep(b));
    let backward = low.x > high.x;
    if backward {
        (low, high) = (high, low);
    }
    let long = high.x - low.x;
    if !(long > 1e-9 && long < LONGEST) {
        return;
    }
    let slope = (high.y - low.y) / long;
    // Extent of the strip along the minor axis, per half width.
    let stretch = (1.0 + slope * slope).sqrt();
    let (columns, count, across, step) =
        if steep { (height, width, width, 1) } else { (width, height, 1, width) };
    let first = (low.x - 0.5).ceil().max(0.0);
    let last = ((high.x - 0.5).ceil() - 1.0).min(columns as f32 - 1.0);
    let mut column = first;
    while column <= last {
        let fraction = (column + 0.5 - low.x) / long;
        let t = if backward { 1.0 - fraction } else { fraction };
        let center = low.y + slope * (column + 0.5 - low.x);
        let half_extent = (half[0] + (half[1] - half[0]) * t) * stretch;
        visit(Slice { t, center, half_extent, first: column as usize * across, step, count });
        column += 1.0;
    }
}

/// Calls `visit` with the index of every sample whose center (0.5, 1.5, …) is in the strip from `a` to `b`, and the
/// fraction of the way from `a`. A strip narrower than a sample covers no sample in some places, but on average as many
/// as its area has. `half` is half its width at both ends.
pub(super) fn samples(ends: [Vec2; 2], half: [f32; 2], size: [usize; 2], mut visit: impl FnMut(usize, f32)) {
    slices(ends, half, size, |slice| {
        let from = (slice.center - slice.half_extent - 0.5).ceil().max(0.0);
        let to = ((slice.center + slice.half_extent - 0.5).ceil() - 1.0).min(slice.count as f32 - 1.0);
        let mut row = from;
        while row <= to {
            visit(slice.first + row as usize * slice.step, slice.t);
            row += 1.0;
        }
    });
}

/// Calls `visit` with the index of every sample that the strip touches, the fraction of the way from its first end, and
/// the fraction of the sample that it covers.
pub(super) fn sample_coverage(
    ends: [Vec2; 2],
    half: [f32; 2],
    size: [usize; 2],
    mut visit: impl FnMut(usize, f32, f32),
) {
    slices(ends, half, size, |slice| {
        let (low, high) = (slice.center - slice.half_extent, slice.center + slice.half_extent);
        let to = (high.ceil() - 1.0).min(slice.count as f32 - 1.0);
        let mut row = low.floor().max(0.0);
        while row <= to {
            let coverage = high.min(row + 1.0) - low.max(row);
            visit(slice.first + row as usize * slice.step, slice.t, coverage);
            row += 1.0;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Rng;

    #[test]
    fn narrow_strips_cover_their_area_on_average() {
        let mut rng = Rng::new(1, 0);
        for half in [0.05, 0.4, 3.0] {
            let (mut found, mut shared, mut area) = (0, 0.0, 0.0);
            for _ in 0..4000 {
                let mut point = || Vec2::new(rng.range(10.0, 90.0), rng.range(10.0, 90.0));
                let ends = [point(), point()];
                area += ends[0].distance(ends[1]) * 2.0 * half;
                samples(ends, [half; 2], [100, 100], |_, t| {
                    assert!((0.0..=1.0).contains(&t));
                    found += 1;
                });
                sample_coverage(ends, [half; 2], [100, 100], |_, _, share| shared += share);
            }
            assert!((shared / area - 1.0).abs() < 0.01, "{half}: {shared} of {area}");
            assert!((found as f32 / area - 1.0).abs() < 0.02, "{half}: {found} of {area}");
        }
    }

    #[test]
    fn fractions_run_from_the_first_end_and_samples_stay_inside() {
        for (a, b) in
            [(Vec2::new(-5.0, 2.0), Vec2::new(30.0, 4.0)), (Vec2::new(3.0, 30.0), Vec2::new(2.0, -5.0))]
        {
            let mut last = None;
            let mut seen = Vec::new();
            samples([a, b], [0.6; 2], [8, 8], |i, t| {
                let at = a.lerp(b, t);
                let center = Vec2::new((i % 8) as f32 + 0.5, (i / 8) as f32 + 0.5);
                assert!(center.distance(at) < 1.0, "{center} {at}");
                seen.push(i);
                last = Some(t);
            });
            assert!(seen.iter().all(|i| *i < 64) && last.is_some());
        }
    }
}
