//! Facial features: sockets, closed lids, nose, lips, chin, cheekbones.

use super::forms::*;
use glam::{Vec2, Vec3, vec3};

/// Adds the features to the distance `d` of the bare head; `p.x` must not be negative.
pub fn features(p: Vec3, d: f32) -> f32 {
    let d = planes(p, d);
    if p.z < 5.0 {
        return d;
    }
    let d = eye(p, d);
    let d = nose(p, d);
    lips(p, d)
}

/// Adds soft bumps and hollows: cheekbones, temples, brow, muzzle, chin.
pub fn planes(p: Vec3, d: f32) -> f32 {
    if p.z < 5.0 {
        return d;
    }
    let cheekbone = hill(p, vec3(49.0, 91.0, 57.0), vec3(28.0, 22.0, 36.0));
    let apple = hill(p, vec3(30.0, 83.0, 82.0), vec3(26.0, 30.0, 30.0));
    let hollow = hill(p, vec3(50.0, 58.0, 47.0), vec3(26.0, 28.0, 42.0));
    let temple = hill(p, vec3(70.0, 134.0, 48.0), vec3(38.0, 40.0, 40.0));
    // The brow ridge is an arch, highest over the outer third of the eye.
    let arch = 131.0 - 0.009 * (p.x - 33.0) * (p.x - 33.0);
    let brow = hill(vec3(p.x, p.y - arch, p.z), vec3(29.0, 0.0, 84.0), vec3(30.0, 12.0, 26.0));
    let muzzle = hill(p, vec3(0.0, 47.0, 94.0), vec3(32.0, 30.0, 34.0));
    let chin = hill(p, vec3(0.0, 12.0, 92.0), vec3(21.0, 18.0, 26.0));
    let fold = hill(p, vec3(0.0, 29.0, 97.0), vec3(22.0, 10.0, 20.0));
    d - 1.8 * cheekbone - 2.0 * apple + 2.2 * hollow + 2.0 * temple - 1.5 * brow - 3.0 * muzzle - 3.0 * chin
        + 1.7 * fold
}

/// Adds the socket, the ball under its closed lids, the line where the lids meet and the fold above.
fn eye(p: Vec3, d: f32) -> f32 {
    let socket = ellipsoid(p, vec3(31.5, 111.3, 99.3), vec3(21.0, 11.3, 16.5));
    let d = carve(d, socket, 18.0);
    let ball = ellipsoid(p, vec3(31.5, 110.0, 66.0), vec3(17.0, 11.5, 14.2));
    let near = 1.0 - step(2.0, 10.0, ball - d);
    if near == 0.0 {
        return d;
    }
    let d = join(d, ball, 6.0);
    // The lids meet low, along an arc that hangs from the corners; the upper lid lies over the lower.
    let t = (p.x - 31.5) / 16.5;
    let along = (1.0 - t * t).max(0.0);
    let seam = p.y - (108.2 - 3.2 * along + 0.9 * t);
    let groove = (1.0 - (seam / 2.2).powi(2)).max(0.0).powi(2);
    let upper = step(-2.0, 1.6, seam) * step(9.0, 2.0, seam);
    let crease = p.y - (110.5 + 5.0 * along + 0.9 * t);
    let crease = (1.0 - (crease / 3.0).powi(2)).max(0.0).powi(2);
    d + near * along * along.sqrt() * (0.9 * groove - 0.6 * upper + 0.6 * crease)
}

fn nose(p: Vec3, d: f32) -> f32 {
    if (p - vec3(0.0, 92.0, 82.0)).length() - 44.0 > d + 16.0 {
        return d;
    }
    let bridge = stroke(p, vec3(0.0, 124.0, 83.5), 4.5, vec3(0.0, 79.0, 103.6), 4.7);
    let flank = stroke(p, vec3(0.0, 118.0, 76.0), 8.5, vec3(0.0, 78.0, 89.0), 11.0);
    let tip = ellipsoid(p, vec3(0.0, 75.5, 103.0), vec3(5.8, 5.8, 8.0));
    let wing = ellipsoid(vec3(astride(p.x, 3.0), p.y, p.z), vec3(5.6, 72.0, 93.5), vec3(4.2, 5.6, 10.0));
    let septum = ellipsoid(p, vec3(0.0, 69.8, 98.5), vec3(4.6, 3.8, 9.5));
    let n = join(join(bridge, flank, 14.0), tip, 10.0);
    let n = join(n, join(wing, septum, 6.0), 9.0);
    let hollow = hill(p, vec3(4.6, 66.4, 98.5), vec3(3.4, 3.6, 6.0));
    join(d, n, 13.0) + 0.6 * hollow
}

/// Adds the lips: two tubes that taper to the corners of the mouth and meet at the parting line.
fn lips(p: Vec3, d: f32) -> f32 {
    let philtrum = hill(p, vec3(0.0, 57.0, 99.0), vec3(5.5, 9.0, 14.0));
    let corner = hill(p, vec3(24.5, 44.5, 86.0), vec3(8.0, 8.0, 12.0));
    let d = d + 0.9 * philtrum + 0.4 * corner;
    if (p - vec3(0.0, 44.0, 84.0)).length() - 32.0 > d + 6.0 {
        return d;
    }
    let taper = (1.0 - (p.x / 23.5).powi(2)).max(-1.0);
    let rise = taper.max(0.0);
    let bow = (1.0 - (p.x / 6.0).powi(2)).max(0.0).powi(2);
    let back = 0.0165 * p.x * p.x;
    let smile = 0.0025 * p.x * p.x;
    // The tubes run backward toward the corners, which shortens the distance across them.
    let run = (1.0 + (0.036 * p.x).powi(2)).sqrt().recip();
    let tube =
        |y: f32, z: f32, r: f32| (Vec2::new(p.y - y - smile, (p.z - z + back) * run).length() - r) * 0.97;
    let upper = tube(44.0 + 3.8 * rise - 1.2 * bow, 94.0 + 0.8 * bow, 0.5 + 4.0 * taper - 0.5 * bow);
    let lower = tube(43.6 - 4.4 * rise * rise.sqrt(), 92.6, 0.3 + 4.8 * taper);
    join(d, join(upper, lower, 1.8), 4.5)
}
