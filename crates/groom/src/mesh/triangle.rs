//! Closest point and solid angle of one triangle.

use std::f32::consts::TAU;

use glam::Vec3;
use std::ops::{Add, Mul};

/// Returns the mean of the values at the corners of a triangle, by barycentric weights.
pub fn mean<T: Mul<f32, Output = T> + Add<Output = T>>([a, b, c]: [T; 3], weights: Vec3) -> T {
    a * weights.x + b * weights.y + c * weights.z
}

/// Returns the point of triangle `[a, b, c]` closest to `p` and its barycentric coordinates (sum 1, none negative). A
/// triangle without area is treated as its longest edge or its point.
pub fn closest_point(p: Vec3, [a, b, c]: [Vec3; 3]) -> (Vec3, Vec3) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (ab_ap, ac_ap) = (ab.dot(ap), ac.dot(ap));
    if ab_ap <= 0.0 && ac_ap <= 0.0 {
        return (a, Vec3::X);
    }
    let bp = p - b;
    let (ab_bp, ac_bp) = (ab.dot(bp), ac.dot(bp));
    if ab_bp >= 0.0 && ac_bp <= ab_bp {
        return (b, Vec3::Y);
    }
    let cp = p - c;
    let (ab_cp, ac_cp) = (ab.dot(cp), ac.dot(cp));
    if ac_cp >= 0.0 && ab_cp <= ac_cp {
        return (c, Vec3::Z);
    }
    // Signed areas (times the triangle's own) of the three triangles that p's projection forms.
    let w = ab_ap * ac_bp - ab_bp * ac_ap;
    let v = ab_cp * ac_ap - ab_ap * ac_cp;
    let u = ab_bp * ac_cp - ab_cp * ac_bp;
    let total = u + v + w;
    // In a sliver, cancellation leaves no digits of the areas, so the edges decide.
    if u > 0.0 && v > 0.0 && w > 0.0 && total > 1e-6 * ab.length_squared() * ac.length_squared() {
        let (v, w) = (v / total, w / total);
        return (a + ab * v + ac * w, Vec3::new((1.0 - v - w).max(0.0), v, w));
    }
    let sides = [
        on_segment(p, a, b, |s, t| Vec3::new(s, t, 0.0)),
        on_segment(p, b, c, |s, t| Vec3::new(0.0, s, t)),
        on_segment(p, c, a, |s, t| Vec3::new(t, 0.0, s)),
    ];
    let far = |side: &(Vec3, Vec3)| p.distance_squared(side.0);
    let mut best = sides[0];
    for side in &sides[1..] {
        if far(side) < far(&best) {
            best = *side;
        }
    }
    best
}

fn on_segment(p: Vec3, a: Vec3, b: Vec3, weights: impl Fn(f32, f32) -> Vec3) -> (Vec3, Vec3) {
    let along = b - a;
    let length = along.length_squared();
    let t = if length > 0.0 { ((p - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * t, weights(1.0 - t, t))
}

/// A sum of signed solid angles of triangles, steradians: positive from behind a triangle, where its corners run
/// clockwise. Source: Van Oosterom and Strackee 1983.
///
/// Their formula gives half the angle as the argument of a complex number. Multiplying these numbers and counting whole
/// turns adds the angles with one arctangent for all triangles.
#[derive(Clone, Copy, Debug)]
pub struct SolidAngle {
    re: f32,
    im: f32,
    revolutions: i32,
}

impl SolidAngle {
    pub const ZERO: Self = Self { re: 1.0, im: 0.0, revolutions: 0 };

    /// Adds the solid angle of triangle `[a, b, c]` seen from `p`: 0 from a corner or an edge.
    pub fn add(&mut self, p: Vec3, [a, b, c]: [Vec3; 3]) {
        let (a, b, c) = (a - p, b - p, c - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let im = a.dot(b.cross(c));
        let re = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        // The magnitude is irrelevant; scaling keeps a product of many numbers from vanishing or overflowing.
        let size = re.abs() + im.abs();
        if size < f32::MIN_POSITIVE || im == 0.0 {
            return;
        }
        let (re, im) = (re / size, im / size);
        let product = (self.re * re - self.im * im, self.re * im + self.im * re);
        // Two angles of up to half a turn to the same side passed the half turn if their sum has the other sign.
        if self.im >= 0.0 && im > 0.0 && product.1 < 0.0 {
            self.revolutions += 1;
        } else if self.im < 0.0 && im < 0.0 && product.1 >= 0.0 {
            self.revolutions -= 1;
        }
        let size = product.0.abs() + product.1.abs();
        (self.re, self.im) = (product.0 / size, product.1 / size);
    }

    /// Returns the sum, steradians.
    pub fn total(self) -> f32 {
        2.0 * self.im.atan2(self.re) + 2.0 * TAU * self.revolutions as f32
    }
}

/// Returns the solid angle of a single triangle.
#[cfg(test)]
pub fn solid_angle(p: Vec3, triangle: [Vec3; 3]) -> f32 {
    let mut angle = SolidAngle::ZERO;
    angle.add(p, triangle);
    angle.total()
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn closest_point_is_found_in_every_region() {
        for (p, expected) in [
            (Vec3::new(0.2, 0.3, 1.0), Vec3::new(0.2, 0.3, 0.0)),
            (Vec3::new(-1.0, -2.0, 1.0), Vec3::ZERO),
            (Vec3::new(3.0, -0.5, 1.0), Vec3::X),
            (Vec3::new(0.1, 4.0, -1.0), Vec3::Y),
            (Vec3::new(0.4, -1.0, 0.0), Vec3::new(0.4, 0.0, 0.0)),
            (Vec3::new(-1.0, 0.7, 0.0), Vec3::new(0.0, 0.7, 0.0)),
            (Vec3::new(1.0, 1.0, 0.3), Vec3::new(0.5, 0.5, 0.0)),
        ] {
            let (q, w) = closest_point(p, T);
            assert!(q.distance(expected) < 1e-6, "{p}: {q}");
            assert!((T[0] * w.x + T[1] * w.y + T[2] * w.z).distance(q) < 1e-6);
        }
    }

    #[test]
    fn flat_triangles_act_as_segments_and_points() {
        let line = [Vec3::ZERO, Vec3::X, Vec3::X * 0.5];
        assert!(closest_point(Vec3::new(0.7, 1.0, 0.0), line).0.distance(Vec3::X * 0.7) < 1e-6);
        assert_eq!(closest_point(Vec3::Y, [Vec3::X; 3]).0, Vec3::X);
    }

    #[test]
    fn an_octant_fills_an_eighth_of_the_sphere() {
        let t = [Vec3::X, Vec3::Y, Vec3::Z];
        assert!((solid_angle(Vec3::ZERO, t) - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!((solid_angle(Vec3::ZERO, [t[0], t[2], t[1]]) + std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert_eq!(solid_angle(Vec3::X, t), 0.0);
    }

    #[test]
    fn accumulated_angle_equals_sum_of_angles() {
        let corner = |i: u32| Vec3::new((i * 7 % 11) as f32, (i * 5 % 13) as f32, (i * 3 % 7) as f32) - 4.0;
        for sign in [1.0, -1.0] {
            let (mut sum, mut apart) = (SolidAngle::ZERO, 0.0f64);
            for i in 0..200 {
                let mut t = [corner(i), corner(i + 17), corner(i + 31)];
                if solid_angle(Vec3::splat(0.3), t) * sign < 0.0 {
                    t.swap(0, 1);
                }
                sum.add(Vec3::splat(0.3), t);
                apart += f64::from(solid_angle(Vec3::splat(0.3), t));
            }
            assert!(apart.abs() > 50.0 && (f64::from(sum.total()) - apart).abs() < 1e-2, "{apart} {sum:?}");
        }
    }
}
