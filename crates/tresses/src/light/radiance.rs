//! Radiance packed into a word, as `light::shade` stores it for strand vertices and shading samples (`radiance.wesl`).

use glam::{UVec3, Vec3};

/// Unpacks radiance: three 9-bit numbers that share an exponent. The error of each is below 0.2 % of the largest.
pub fn unpack_radiance(word: u32) -> Vec3 {
    let digits = UVec3::new(word, word >> 9, word >> 18) & 511;
    digits.as_vec3() * ((word >> 27) as f32 - 24.0).exp2()
}
