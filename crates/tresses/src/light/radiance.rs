//! Radiance in a word, as `light::shade` leaves it at each strand vertex and at each knot (`radiance.wesl`).

use glam::{UVec3, Vec3};

/// The radiance in a word: three numbers of nine bits and one exponent, each off by less than 0.2 % of the largest.
pub fn unpack_radiance(word: u32) -> Vec3 {
    let digits = UVec3::new(word, word >> 9, word >> 18) & 511;
    digits.as_vec3() * ((word >> 27) as f32 - 24.0).exp2()
}
