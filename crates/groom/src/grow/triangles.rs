//! Delaunay triangulation of the guide roots, and barycentric weights within it.

use glam::{DVec2, Vec2};

/// Returns a Delaunay triangulation of `points`, as the corners of each triangle.
pub(crate) fn delaunay(points: &[Vec2]) -> Vec<[u32; 3]> {
    let n = points.len();
    if n < 3 {
        return Vec::new();
    }
    let first = points[0].as_dvec2();
    let (lo, hi) =
        points.iter().fold((first, first), |(lo, hi), p| (lo.min(p.as_dvec2()), hi.max(p.as_dvec2())));
    let center = 0.5 * (lo + hi);
    let span = (hi - lo).max_element().max(1e-9) * 1e3;
    // Three corners far outside form a triangle around all points; their triangles are dropped at the end.
    let mut all: Vec<DVec2> = points.iter().map(|p| p.as_dvec2()).collect();
    all.extend([
        center + DVec2::new(-span, -span),
        center + DVec2::new(span, -span),
        center + DVec2::new(0.0, span),
    ]);
    let mut triangles = vec![Circumcircle::new(&all, [n as u32, n as u32 + 1, n as u32 + 2])];
    let mut edges: Vec<(u32, u32)> = Vec::new();
    for i in 0..n {
        edges.clear();
        triangles.retain(|triangle| {
            let hit = triangle.center.distance_squared(all[i]) < triangle.radius_squared;
            if hit {
                let [a, b, c] = triangle.corners;
                edges.extend([(a, b), (b, c), (c, a)]);
            }
            !hit
        });
        for k in 0..edges.len() {
            let (a, b) = edges[k];
            // An edge between two removed triangles lies inside the hole.
            if !edges.contains(&(b, a)) {
                triangles.push(Circumcircle::new(&all, [a, b, i as u32]));
            }
        }
    }
    triangles.retain(|triangle| triangle.corners.iter().all(|&c| (c as usize) < n));
    triangles.into_iter().map(|triangle| triangle.corners).collect()
}

struct Circumcircle {
    corners: [u32; 3],
    center: DVec2,
    radius_squared: f64,
}

impl Circumcircle {
    fn new(points: &[DVec2], corners: [u32; 3]) -> Self {
        let [a, b, c] = corners.map(|i| points[i as usize]);
        let (u, v) = (b - a, c - a);
        let twice = 2.0 * u.perp_dot(v);
        let (uu, vv) = (u.length_squared(), v.length_squared());
        let offset = DVec2::new(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / twice;
        let radius_squared = if twice.abs() > 1e-18 { offset.length_squared() } else { f64::INFINITY };
        Self { corners, center: if radius_squared.is_finite() { a + offset } else { a }, radius_squared }
    }
}

/// Returns the weights of a triangle's corners at its point nearest to `p`, and the squared distance to that point,
/// which is 0 inside.
pub(crate) fn weights(corners: [Vec2; 3], p: Vec2) -> ([f32; 3], f32) {
    let [a, b, c] = corners;
    let area = (b - a).perp_dot(c - a);
    if area.abs() > 1e-12 {
        let w = [(b - p).perp_dot(c - p) / area, (c - p).perp_dot(a - p) / area];
        let w = [w[0], w[1], 1.0 - w[0] - w[1]];
        if w.iter().all(|&w| w >= 0.0) {
            return (w, 0.0);
        }
    }
    let mut best = ([1.0, 0.0, 0.0], f32::INFINITY);
    for k in 0..3 {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let edge = to - from;
        let t = ((p - from).dot(edge) / edge.length_squared().max(1e-12)).clamp(0.0, 1.0);
        let d = (from + edge * t).distance_squared(p);
        if d < best.1 {
            let mut w = [0.0; 3];
            w[k] = 1.0 - t;
            w[(k + 1) % 3] = t;
            best = (w, d);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Rng;

    #[test]
    fn delaunay_circumcircles_are_empty() {
        let mut rng = Rng::new(3, 1);
        let points: Vec<Vec2> = (0..120).map(|_| Vec2::new(rng.unit(), rng.unit())).collect();
        let triangles = delaunay(&points);
        let all: Vec<DVec2> = points.iter().map(|p| p.as_dvec2()).collect();
        let empty = |triangles: &[[u32; 3]]| {
            triangles.iter().all(|t| {
                let circle = Circumcircle::new(&all, *t);
                all.iter()
                    .all(|p| p.distance_squared(circle.center) > circle.radius_squared * (1.0 - 1e-9) - 1e-12)
            })
        };
        assert!(triangles.len() > 200 && empty(&triangles));
        // The check detects a wrong corner.
        let mut wrong = triangles.clone();
        let t = wrong[10];
        wrong[10][2] = (0..120u32).find(|i| !t.contains(i)).unwrap_or(0);
        assert!(!empty(&wrong));
    }

    #[test]
    fn weights_are_barycentric_inside_and_clamped_outside() {
        let t = [Vec2::ZERO, Vec2::X, Vec2::Y];
        let (w, d) = weights(t, Vec2::new(0.25, 0.5));
        assert!((w[0] - 0.25).abs() < 1e-6 && (w[1] - 0.25).abs() < 1e-6 && d == 0.0);
        let (w, d) = weights(t, Vec2::new(0.5, -0.3));
        assert!((w[0] - 0.5).abs() < 1e-6 && w[2] == 0.0 && (d - 0.09).abs() < 1e-6);
    }
}
