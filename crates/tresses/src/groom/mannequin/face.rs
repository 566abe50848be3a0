//! The face's features: sockets, closed lids, nose, lips, chin, cheekbones.

use super::forms::*;
use glam::{Vec2, Vec3, vec3};

/// Adds the features to the distance `d` of the bare head. `p.x` is not negative.
pub fn features(p: Vec3, d: f32) -> f32 {
    let d = planes(p, d);
    if p.z < 5.0 {
        return d;
    }
    let d = eye(p, d);
    let d = nose(p, d);
    lips(p, d)
}

/// Soft pushes of clay: cheekbones, temples, brow, muzzle, chin.
pub fn planes(p: Vec3, d: f32) -> f32 {
    if p.z < 5.0 {
        return d;
    }
    let cheekbone = hill(p, vec3(50.0, 88.0, 56.0), vec3(26.0, 20.0, 34.0));
    let apple = hill(p, vec3(31.0, 80.0, 82.0), vec3(25.0, 28.0, 30.0));
    let hollow = hill(p, vec3(52.0, 58.0, 45.0), vec3(24.0, 26.0, 40.0));
    let temple = hill(p, vec3(70.0, 134.0, 48.0), vec3(38.0, 40.0, 40.0));
    let brow = hill(p, vec3(28.0, 134.0, 86.0), vec3(32.0, 15.0, 24.0));
    let muzzle = hill(p, vec3(0.0, 44.0, 94.0), vec3(32.0, 30.0, 34.0));
    let chin = hill(p, vec3(0.0, 11.0, 92.0), vec3(24.0, 17.0, 26.0));
    let fold = hill(p, vec3(0.0, 26.5, 97.0), vec3(24.0, 9.0, 20.0));
    d - 2.0 * cheekbone - 2.4 * apple + 2.0 * hollow + 2.0 * temple - 1.3 * brow - 3.5 * muzzle - 3.0 * chin
        + 2.4 * fold
}

/// The socket, the ball under its closed lids, the line where the lids meet and the fold above.
fn eye(p: Vec3, d: f32) -> f32 {
    let socket = ellipsoid(p, vec3(32.0, 112.5, 98.0), vec3(24.0, 13.5, 16.0));
    let d = carve(d, socket, 15.0);
    let ball = ellipsoid(p, vec3(32.0, 110.5, 67.0), vec3(17.0, 11.5, 14.8));
    let near = 1.0 - step(2.0, 10.0, ball - d);
    if near == 0.0 {
        return d;
    }
    let d = join(d, ball, 4.0);
    // The lids meet low, along an arc that hangs from the corners; the upper one lies over the lower.
    let t = (p.x - 32.5) / 18.0;
    let along = (1.0 - t * t).max(0.0);
    let seam = p.y - (108.0 - 3.8 * along + 0.8 * t);
    let groove = (1.0 - (seam / 1.8).powi(2)).max(0.0).powi(2);
    let upper = step(-1.6, 1.2, seam) * step(13.0, 2.0, seam);
    d + near * along * along.sqrt() * (0.6 * groove - 0.8 * upper)
}

fn nose(p: Vec3, d: f32) -> f32 {
    if (p - vec3(0.0, 88.0, 82.0)).length() - 46.0 > d + 10.0 {
        return d;
    }
    let bridge = stroke(p, (vec3(0.0, 123.0, 82.5), 6.0), (vec3(0.0, 74.0, 104.5), 5.8));
    let flank = stroke(p, (vec3(0.0, 117.0, 74.0), 11.0), (vec3(0.0, 74.0, 88.0), 15.0));
    let tip = ellipsoid(p, vec3(0.0, 70.8, 104.5), vec3(7.6, 7.6, 9.0));
    let wing = ellipsoid(vec3(astride(p.x, 3.0), p.y, p.z), vec3(7.2, 65.6, 94.0), vec3(6.0, 6.4, 10.0));
    let septum = ellipsoid(p, vec3(0.0, 64.0, 96.0), vec3(8.0, 4.8, 11.0));
    let n = join(join(bridge, flank, 16.0), tip, 8.0);
    let n = join(join(n, wing, 9.0), septum, 6.0);
    let hollow = hill(p, vec3(5.8, 59.0, 98.0), vec3(4.5, 4.5, 6.0));
    join(d, n, 8.0) + 0.8 * hollow
}

/// Two tubes that taper to the corners of the mouth; where they meet is the parting line.
fn lips(p: Vec3, d: f32) -> f32 {
    let philtrum = hill(p, vec3(0.0, 53.0, 99.0), vec3(6.0, 10.0, 14.0));
    let corner = hill(p, vec3(26.0, 40.0, 86.0), vec3(9.0, 8.0, 12.0));
    let d = d + 1.0 * philtrum + 0.5 * corner;
    if (p - vec3(0.0, 40.0, 84.0)).length() - 32.0 > d + 6.0 {
        return d;
    }
    let taper = (1.0 - (p.x / 25.0).powi(2)).max(-1.0);
    let rise = taper.max(0.0);
    let bow = (1.0 - (p.x / 6.0).powi(2)).max(0.0).powi(2);
    let back = 0.017 * p.x * p.x;
    let smile = 0.0018 * p.x * p.x;
    // The tubes run backwards towards the corners; the distance across them is that much shorter.
    let run = (1.0 + (0.034 * p.x).powi(2)).sqrt().recip();
    let tube =
        |y: f32, z: f32, r: f32| (Vec2::new(p.y - y - smile, (p.z - z + back) * run).length() - r) * 0.97;
    let upper = tube(40.4 + 3.2 * rise - 0.5 * bow, 95.0 + 0.5 * bow, 0.6 + 3.8 * taper - 0.4 * bow);
    let lower = tube(40.0 - 4.4 * rise, 93.2, 0.4 + 4.8 * taper);
    join(d, join(upper, lower, 3.6), 5.0)
}
