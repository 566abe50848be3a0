//! Modeling tools: solid forms as signed distances, and smooth blends of them.
//!
//! All lengths are in millimeters. The gradient of every form has unit length, or nearly so close to its surface.
//! Blends are convex in the gradients, so they never lengthen the gradients of the forms.

use glam::{Vec2, Vec3};

/// Returns the union of two solids with a fillet of size `k`, which is also the largest difference of the two distances
/// at which the fillet has an effect. The blend is cubic: with continuous curvature, highlights do not show where one
/// form ends.
pub fn join(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * h * k * (1.0 / 6.0)
}

/// Returns the intersection of two solids with a rounded edge.
pub fn intersect(a: f32, b: f32, k: f32) -> f32 {
    -join(-a, -b, k)
}

/// Returns `a` without `b`, with a rounded edge.
pub fn carve(a: f32, b: f32, k: f32) -> f32 {
    intersect(a, -b, k)
}

/// Returns the distance to an ellipsoid about `c` with semi-axes `r`: exact on its surface, within a few percent near
/// it.
pub fn ellipsoid(p: Vec3, c: Vec3, r: Vec3) -> f32 {
    let q = (p - c) / r;
    let (value, slope) = (q.length(), (q / r).length());
    if slope < 1e-9 { -r.min_element() } else { value * (value - 1.0) / slope }
}

/// Returns the distance to the hull of two spheres about `a` and `b`. The sphere that touches the hull nearest to `p`
/// is found in closed form: seen from its center, `p` lies along the normal of the hull, which the taper tilts.
pub fn stroke(p: Vec3, a: Vec3, ra: f32, b: Vec3, rb: f32) -> f32 {
    let axis = b - a;
    let length = axis.length();
    let along = (p - a).dot(axis) / length;
    let across = ((p - a).length_squared() - along * along).max(0.0).sqrt();
    let lean = (ra - rb) / length;
    let foot = (along - across * lean / (1.0 - lean * lean).max(1e-4).sqrt()).clamp(0.0, length);
    Vec2::new(along - foot, across).length() - ra - (rb - ra) * foot / length
}

/// Returns a soft bump of height 1 at `c` that ends at the ellipsoid with semi-axes `r`. Added to a distance with a
/// small factor, it moves the surface in or out. The steepest slope is 1.7 per semi-axis.
pub fn hill(p: Vec3, c: Vec3, r: Vec3) -> f32 {
    let h = (1.0 - ((p - c) / r).length_squared()).max(0.0);
    h * h * h
}

/// Returns the Hermite step from 0 at `a` to 1 at `b`.
pub fn step(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Evaluates a profile over the height `y`: a uniform cubic B-spline over `control_values`, the first at `start`, the
/// others `spacing` apart. Returns value and slope. Constant beyond the ends.
pub fn curve(control_values: &[f32], start: f32, spacing: f32, y: f32) -> (f32, f32) {
    let last = control_values.len() as i32 - 1;
    let s = ((y - start) / spacing).clamp(0.0, last as f32);
    let i = (s as i32).min(last - 1);
    let f = s - i as f32;
    let at = |j: i32| control_values[(i + j).clamp(0, last) as usize];
    let (a, b, c, d) = (at(-1), at(0), at(1), at(2));
    let g = 1.0 - f;
    let value = (g * g * g * a
        + (4.0 - 3.0 * f * f * (2.0 - f)) * b
        + (4.0 - 3.0 * g * g * (2.0 - g)) * c
        + f * f * f * d)
        / 6.0;
    let slope = (g * g * (b - a) + (1.0 + 2.0 * f * g) * (c - b) + f * f * (d - c)) / (2.0 * spacing);
    (value, slope)
}

/// Returns `x` without a kink at zero, so that forms across the mirror plane meet smoothly. Away from the plane, the
/// result is too small by up to `k`.
pub fn astride(x: f32, k: f32) -> f32 {
    x.hypot(k) - k
}
