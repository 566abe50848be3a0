//! Polylines with any number of vertices become polylines with a given number.

use super::Strands;
use glam::Vec3;

/// `count` points along `polyline` at equal distances of arc length; the first and the last are
/// exactly those of the polyline. A polyline of one point gives that point `count` times.
pub fn polyline(polyline: &[Vec3], count: usize) -> Vec<Vec3> {
    let (Some(first), Some(last)) = (polyline.first(), polyline.last()) else { return Vec::new() };
    // In double precision: the error of a long polyline's running sum stays far below a vertex.
    let total: f64 = polyline.windows(2).map(|w| f64::from(w[0].distance(w[1]))).sum();
    let mut out = Vec::with_capacity(count);
    let (mut segment, mut before) = (0, 0.0f64);
    for i in 0..count {
        if i == 0 || i + 1 == count {
            out.push(if i == 0 { *first } else { *last });
            continue;
        }
        let at = total * i as f64 / (count - 1) as f64;
        while segment + 2 < polyline.len() {
            let length = f64::from(polyline[segment].distance(polyline[segment + 1]));
            if before + length >= at {
                break;
            }
            before += length;
            segment += 1;
        }
        let Some([a, b]) = polyline.get(segment..segment + 2) else {
            out.push(*first);
            continue;
        };
        let length = f64::from(a.distance(*b));
        let t = if length > 0.0 { ((at - before) / length).clamp(0.0, 1.0) } else { 0.0 };
        out.push(a.lerp(*b, t as f32));
    }
    out
}

/// Every strand with `count` vertices, guide-major: strand `i` has `i * count..(i + 1) * count`.
pub fn strands(strands: &Strands, count: usize) -> Vec<Vec3> {
    strands.iter().flat_map(|strand| polyline(strand, count)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_distances_and_exact_ends() {
        let source: Vec<_> = (0..37).map(|i| Vec3::new((i * i) as f32 * 1e-3, 0.1, 0.3)).collect();
        let out = polyline(&source, 16);
        assert_eq!((out[0], out[15]), (source[0], source[36]));
        let step = source[36].distance(source[0]) / 15.0;
        for w in out.windows(2) {
            assert!((w[0].distance(w[1]) - step).abs() < 1e-5 * step.max(1.0));
        }
    }

    #[test]
    fn degenerate_polylines_do_not_panic() {
        assert!(polyline(&[], 8).is_empty());
        assert_eq!(polyline(&[Vec3::X], 3), vec![Vec3::X; 3]);
        assert_eq!(polyline(&[Vec3::X, Vec3::X], 4), vec![Vec3::X; 4]);
        assert_eq!(polyline(&[Vec3::ZERO, Vec3::X], 1), vec![Vec3::ZERO]);
    }
}
