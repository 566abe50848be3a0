//! The ears: a tilted dish with a rolled rim, a bowl and a lobe.

use super::forms::*;
use glam::{Vec2, Vec3, vec2, vec3};

/// The middle of the ear where it leaves the head, and how its dish is turned: leaning back by 14°,
/// standing off the head by 24°.
const MIDDLE: Vec3 = vec3(71.5, 90.0, -9.0);

/// The ear's distance; `p.x` is not negative.
pub fn ear(p: Vec3) -> f32 {
    let q = p - MIDDLE;
    let bound = q.length() - 42.0;
    if bound > 20.0 {
        return bound;
    }
    // Ear frame: x backwards along the dish, y up along it, z out of the bowl.
    let (back, out) = (vec3(0.407, 0.0, -0.914), vec3(0.914, 0.0, 0.407));
    let lean = Vec2::from_angle(0.24);
    let flat = lean.rotate(vec2(q.dot(back), q.y));
    let (u, v, w) = (flat.x, flat.y, q.dot(out));
    let e = outline(vec2(u, v));
    let dish = meet(e, (w + 0.5 - 0.012 * (u * u + 0.4 * v * v)).abs() - 2.9, 2.5);
    // The rim rolls from the bowl's front edge over the top and fades into the lobe.
    let present = step(-24.0, -8.0, v) * step(-14.0, -4.0, u + 0.35 * (v - 10.0).max(0.0));
    let rim = Vec2::new(e + 2.2, w - 2.6).length() - (4.8 * present - 2.0);
    let lobe = ellipsoid(vec3(u, v, w), vec3(-3.0, -24.0, 0.5), vec3(7.0, 8.0, 3.6));
    let tragus = ellipsoid(vec3(u, v, w), vec3(-12.0, -6.0, 2.0), vec3(4.0, 6.5, 4.0));
    let fold = stroke(vec3(u, v, w), (vec3(6.0, 10.0, 1.0), 2.2), (vec3(5.0, -12.0, 1.0), 2.6));
    let bowl = ellipsoid(vec3(u, v, w), vec3(-4.0, -5.0, 5.0), vec3(7.0, 10.0, 5.0));
    let root = ellipsoid(vec3(u, v, w), vec3(-5.0, -1.0, -9.0), vec3(13.0, 23.0, 9.5));
    let d = join(join(dish, rim, 2.5), join(lobe, fold, 4.0), 5.0);
    let d = carve(join(d, root, 6.0), bowl, 3.0);
    join(d, tragus, 3.0)
}

/// The dish's outline: an egg, broad above.
fn outline(q: Vec2) -> f32 {
    let t = (q.y / 31.0).clamp(-1.0, 1.0);
    let wide = 14.5 + 4.0 * t;
    let r = vec2(wide, 31.0);
    let n = vec2(q.x + 1.0, q.y) / r;
    let (value, slope) = (n.length(), (n / r).length());
    if slope < 1e-6 { -wide } else { value * (value - 1.0) / slope }
}
