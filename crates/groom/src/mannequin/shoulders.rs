//! Shoulders, collarbones and upper chest, with the cut that ends the bust.

use super::forms::*;
use glam::{Vec3, vec3};

/// Offset that raises the shoulders above the height of their coordinates, mm.
const RISE: f32 = 10.0;

/// Upper bound of the height of the torso, mm.
pub const TOP: f32 = 0.0;

/// Returns the signed distance to the torso before the cut, mm; `p.x` must not be negative.
pub fn torso(p: Vec3) -> f32 {
    let p = p - vec3(0.0, RISE, 0.0);
    let chest = ellipsoid(p, vec3(0.0, -220.0, -50.0), vec3(150.0, 122.0, 82.0));
    let girdle = stroke(p, vec3(0.0, -140.0, -62.0), 40.0, vec3(150.0, -152.0, -60.0), 40.0);
    let q = vec3(astride(p.x, 8.0), p.y, p.z);
    let trapezius = stroke(q, vec3(14.0, -50.0, -62.0), 24.0, vec3(122.0, -128.0, -64.0), 20.0);
    let deltoid = ellipsoid(p, vec3(162.0, -184.0, -56.0), vec3(42.0, 74.0, 46.0));
    let breast = |x: f32| ellipsoid(p, vec3(x, -240.0, -2.0), vec3(60.0, 70.0, 44.0));
    let d = join(chest, girdle, 60.0);
    let d = join(d, trapezius, 45.0);
    let d = join(d, deltoid, 60.0);
    // Breast muscle and shoulder blade run into the arm.
    let pectoral = stroke(p, vec3(50.0, -195.0, -8.0), 28.0, vec3(150.0, -172.0, -48.0), 30.0);
    let blade = stroke(p, vec3(60.0, -190.0, -92.0), 32.0, vec3(150.0, -165.0, -72.0), 30.0);
    let d = join(join(d, pectoral, 40.0), blade, 50.0);
    let d = join(d, join(breast(66.0), breast(-66.0), 40.0), 50.0);
    let clavicle = stroke(q, vec3(11.0, -107.0, -10.0), 6.0, vec3(142.0, -120.0, -42.0), 4.0);
    join(d, clavicle, 22.0)
}

/// Returns the signed distance to the cut. It ends the bust below the curve that swings from the arms down to the
/// breastbone.
pub fn cut(p: Vec3) -> f32 {
    let q = vec3(p.x, p.y + 60.0, 0.0);
    ellipsoid(q, Vec3::ZERO, vec3(238.0, 172.0, 1e4))
}
