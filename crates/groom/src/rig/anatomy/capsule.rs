//! Capsules that approximate parts of a body: least-squares fits to the surface of the part.
//!
//! The unknowns are the ends `a`, `b` of an axis and a radius `r`. A point `p` of the part deviates by `|p − c| − r`,
//! where `c` is the point of the axis closest to it. The sum of squares, each weighted by the area around its point, is
//! minimized by damped Gauss–Newton steps (Levenberg 1944, Marquardt 1963). It has several minima, so three searches
//! start along the principal axes of the points, and the best result is kept. A tube that is open where it was cut gets
//! an axis of its full length, a finger one that ends before its tip.

use crate::TriMesh;
use glam::Vec3;

/// Distance outside of a capsule from which on surface counts as missed, meters.
pub const STANDS_OUT: f32 = 5e-3;
/// Maximum number of points for a fit; more do not improve it.
const ENOUGH: usize = 600;
/// Maximum number of steps of a search.
const STEPS: usize = 40;

/// A capsule in place of a part of a body, groom space, meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Ends of the axis.
    pub ends: [Vec3; 2],
    /// Radius.
    pub radius: f32,
}

impl Capsule {
    /// Returns the signed distance of a point from the surface, negative inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        p.distance(self.next_to(p).0) - self.radius
    }

    /// Returns the point of the axis closest to `p`, and its position along the axis, from 0 to 1.
    fn next_to(&self, p: Vec3) -> (Vec3, f32) {
        let [a, b] = self.ends;
        let axis = b - a;
        let square = axis.length_squared();
        let along = if square > 1e-12 { ((p - a).dot(axis) / square).clamp(0.0, 1.0) } else { 0.5 };
        (a + axis * along, along)
    }
}

/// A capsule and the quality of its fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapsuleFit {
    /// Fitted capsule.
    pub capsule: Capsule,
    /// Deviation of the part's surface, root mean square over its area, meters.
    pub off: f32,
    /// Fraction of the part's surface that stands out of the capsule by more than [`STANDS_OUT`].
    pub missed: f32,
}

/// Fits a capsule to the part of `mesh` that has these triangles and, of their vertices, those for which `is_own`
/// returns true. Returns `None` if these are too few.
pub fn fit(mesh: &TriMesh, triangles: &[[u32; 3]], is_own: impl Fn(u32) -> bool) -> Option<CapsuleFit> {
    let points = points(mesh, triangles, is_own);
    if points.len() < 4 {
        return None;
    }
    let total_area: f64 = points.iter().map(|(_, weight)| f64::from(*weight)).sum();
    let start = axes(&points);
    let found = start.iter().filter_map(|axis| search(&points, begin(&points, *axis)));
    let (cost, capsule) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let out = points.iter().filter(|(p, _)| capsule.distance(*p) > STANDS_OUT);
    let missed = out.fold(0.0, |sum, (_, weight)| sum + f64::from(*weight)) / total_area;
    Some(CapsuleFit { capsule, off: (cost / total_area).sqrt() as f32, missed: missed as f32 })
}

/// Returns vertices with the area around each.
fn points(mesh: &TriMesh, triangles: &[[u32; 3]], is_own: impl Fn(u32) -> bool) -> Vec<(Vec3, f32)> {
    let mut areas = std::collections::BTreeMap::<u32, f32>::new();
    for corners in triangles {
        let [a, b, c] = corners.map(|vertex| mesh.positions[vertex as usize]);
        let third = (b - a).cross(c - a).length() / 6.0;
        for vertex in corners.iter().filter(|vertex| is_own(**vertex)) {
            *areas.entry(*vertex).or_default() += third;
        }
    }
    let solid = areas.into_iter().filter(|(_, area)| *area > 0.0);
    let all: Vec<_> = solid.map(|(vertex, area)| (mesh.positions[vertex as usize], area)).collect();
    let step = all.len().div_ceil(ENOUGH).max(1);
    all.into_iter().step_by(step).collect()
}

/// Returns the principal axes of the points, by Jacobi rotations.
fn axes(points: &[(Vec3, f32)]) -> [Vec3; 3] {
    let total_area: f32 = points.iter().map(|(_, weight)| weight).sum();
    let center = points.iter().map(|(p, weight)| *p * *weight).sum::<Vec3>() / total_area;
    let mut m = [[0.0f32; 3]; 3];
    for (p, weight) in points {
        let d = (*p - center).to_array();
        for (i, row) in m.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate() {
                *cell += weight / total_area * d[i] * d[j];
            }
        }
    }
    let mut v = [Vec3::X, Vec3::Y, Vec3::Z];
    for _ in 0..8 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if m[i][j].abs() < 1e-20 {
                continue;
            }
            let angle = 0.5 * (2.0 * m[i][j]).atan2(m[i][i] - m[j][j]);
            let (s, c) = angle.sin_cos();
            let (upper, lower) = (m[i], m[j]);
            m[i] = std::array::from_fn(|k| c * upper[k] + s * lower[k]);
            m[j] = std::array::from_fn(|k| c * lower[k] - s * upper[k]);
            for row in &mut m {
                (row[i], row[j]) = (c * row[i] + s * row[j], c * row[j] - s * row[i]);
            }
            (v[i], v[j]) = (v[i] * c + v[j] * s, v[j] * c - v[i] * s);
        }
    }
    v
}

/// Returns a capsule along `axis` with the mean radius of the points and, round ends included, their length.
fn begin(points: &[(Vec3, f32)], axis: Vec3) -> Capsule {
    let total_area: f32 = points.iter().map(|(_, weight)| weight).sum();
    let center = points.iter().map(|(p, weight)| *p * *weight).sum::<Vec3>() / total_area;
    let along = |p: Vec3| (p - center).dot(axis);
    let (lo, hi) = points
        .iter()
        .map(|(p, _)| along(*p))
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), t| (lo.min(t), hi.max(t)));
    let radial_distance = |p: Vec3| (p - center - axis * along(p)).length();
    let radius = points.iter().map(|(p, weight)| radial_distance(*p) * weight).sum::<f32>() / total_area;
    let inset = radius.min(0.45 * (hi - lo));
    Capsule { ends: [center + axis * (lo + inset), center + axis * (hi - inset)], radius: radius.max(1e-4) }
}

/// Returns the sum of squared deviations from a capsule, weighted by area.
fn cost(points: &[(Vec3, f32)], capsule: &Capsule) -> f64 {
    points.iter().map(|(p, weight)| f64::from(*weight) * f64::from(capsule.distance(*p)).powi(2)).sum()
}

/// Minimizes the cost from `capsule` on. Returns the lowest cost and its capsule.
fn search(points: &[(Vec3, f32)], mut capsule: Capsule) -> Option<(f64, Capsule)> {
    let mut best = cost(points, &capsule);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let (mut normal, mut right) = ([[0.0f64; 7]; 7], [0.0f64; 7]);
        for (p, weight) in points {
            let (next, along) = capsule.next_to(*p);
            let offset = *p - next;
            let far = offset.length();
            if far < 1e-9 {
                continue;
            }
            let n = offset / far;
            let slope = [(n * (along - 1.0)).to_array(), (n * -along).to_array()].concat();
            let slope: [f64; 7] = std::array::from_fn(|i| slope.get(i).map_or(-1.0, |s| f64::from(*s)));
            let off = f64::from(far - capsule.radius);
            for i in 0..7 {
                right[i] -= f64::from(*weight) * slope[i] * off;
                for j in 0..7 {
                    normal[i][j] += f64::from(*weight) * slope[i] * slope[j];
                }
            }
        }
        let trace: f64 = (0..7).map(|i| normal[i][i]).sum::<f64>() / 7.0;
        (0..7).for_each(|i| normal[i][i] += damping * trace + 1e-12 * trace);
        let step = solve(normal, right)?.map(|x| x as f32);
        let [a, b] = capsule.ends;
        let tried = Capsule {
            ends: [a + Vec3::from_slice(&step[..3]), b + Vec3::from_slice(&step[3..6])],
            radius: capsule.radius + step[6],
        };
        let tried_cost = cost(points, &tried);
        if tried.radius > 0.0 && tried_cost < best {
            let gained = best - tried_cost;
            (capsule, best, damping) = (tried, tried_cost, (damping * 0.3).max(1e-7));
            if gained < 1e-7 * best {
                break;
            }
        } else {
            damping *= 8.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    best.is_finite().then_some((best, capsule))
}

/// Solves a small linear system by elimination with pivoting.
fn solve(mut m: [[f64; 7]; 7], mut b: [f64; 7]) -> Option<[f64; 7]> {
    for i in 0..7 {
        let pivot = (i..7).max_by(|x, y| m[*x][i].abs().total_cmp(&m[*y][i].abs()))?;
        if m[pivot][i].abs() < 1e-30 {
            return None;
        }
        m.swap(i, pivot);
        b.swap(i, pivot);
        for row in i + 1..7 {
            let factor = m[row][i] / m[i][i];
            let above = m[i];
            (i..7).for_each(|k| m[row][k] -= factor * above[k]);
            b[row] -= factor * b[i];
        }
    }
    let mut x = [0.0; 7];
    for i in (0..7).rev() {
        let known: f64 = (i + 1..7).map(|k| m[i][k] * x[k]).sum();
        x[i] = (b[i] - known) / m[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    /// A tilted tube; `profile` is (height, radius) from ring to ring.
    fn tube(profile: &[(f32, f32)]) -> TriMesh {
        const SIDES: u32 = 24;
        let turn = Quat::from_rotation_z(0.4) * Quat::from_rotation_x(1.1);
        let mut mesh = TriMesh::default();
        for (ring, (height, radius)) in profile.iter().enumerate() {
            for side in 0..SIDES {
                let (s, c) = (side as f32 * std::f32::consts::TAU / SIDES as f32).sin_cos();
                mesh.positions.push(turn * Vec3::new(radius * s, *height, radius * c) + Vec3::splat(0.3));
                if ring + 1 < profile.len() {
                    let (a, b) = (ring as u32 * SIDES + side, ring as u32 * SIDES + (side + 1) % SIDES);
                    mesh.triangles.extend([[a, b, b + SIDES], [a, b + SIDES, a + SIDES]]);
                }
            }
        }
        mesh
    }

    fn fitted(mesh: &TriMesh) -> CapsuleFit {
        fit(mesh, &mesh.triangles, |_| true).unwrap()
    }

    #[test]
    fn fit_recovers_a_capsule() {
        let round = |t: f32| (0.04 * t.sin(), 0.04 * t.cos());
        let quarter = |i: u32| round(i as f32 / 12.0 * std::f32::consts::FRAC_PI_2);
        let mut profile: Vec<_> = (1..=12).rev().map(|i| (-0.1 - quarter(i).0, quarter(i).1)).collect();
        profile.extend((0..=16).map(|i| (-0.1 + i as f32 * 0.0125, 0.04)));
        profile.extend((1..=12).map(|i| (0.1 + quarter(i).0, quarter(i).1)));
        let found = fitted(&tube(&profile));
        let long = found.capsule.ends[0].distance(found.capsule.ends[1]);
        assert!((found.capsule.radius - 0.04).abs() < 1e-4 && (long - 0.2).abs() < 5e-4, "{found:?}");
        assert!(found.off < 1e-4 && found.missed == 0.0, "{found:?}");
        // The measures detect a part that bulges in its middle by 12 mm.
        profile[17..24].iter_mut().for_each(|(_, radius)| *radius += 0.012);
        let bulges = fitted(&tube(&profile));
        assert!(bulges.off > 1e-3 && bulges.missed > 0.05, "{bulges:?}");
    }

    #[test]
    fn fit_covers_open_tube_and_averages_cone() {
        let straight: Vec<_> = (0..=20).map(|i| (i as f32 * 0.015, 0.05)).collect();
        let found = fitted(&tube(&straight));
        assert!((found.capsule.radius - 0.05).abs() < 1e-3 && found.missed == 0.0, "{found:?}");
        let long = found.capsule.ends[0].distance(found.capsule.ends[1]);
        assert!((0.24..0.32).contains(&long), "{long}");
        let cone: Vec<_> = (0..=20).map(|i| (i as f32 * 0.015, 0.05 - i as f32 * 0.001)).collect();
        let found = fitted(&tube(&cone));
        assert!((0.035..0.045).contains(&found.capsule.radius), "{found:?}");
        assert!((1e-3..8e-3).contains(&found.off) && found.missed < 0.35, "{found:?}");
    }

    #[test]
    fn fit_uses_own_vertices_and_rejects_too_few() {
        let straight: Vec<_> = (0..=20).map(|i| (i as f32 * 0.015, 0.05)).collect();
        let mesh = tube(&straight);
        let lower = fit(&mesh, &mesh.triangles, |vertex| vertex < 24 * 8).unwrap();
        let long = lower.capsule.ends[0].distance(lower.capsule.ends[1]);
        assert!(long < 0.15, "{long}");
        assert!(fit(&mesh, &mesh.triangles, |vertex| vertex < 3).is_none());
        assert!(fit(&TriMesh::default(), &[], |_| true).is_none());
        let flat =
            TriMesh { positions: vec![Vec3::ONE; 8], triangles: vec![[0, 1, 2]], ..Default::default() };
        assert!(fit(&flat, &flat.triangles, |_| true).is_none());
    }
}
