//! Random numbers that depend only on their seed.

/// PCG output permutation of Jarzynski and Olano, "Hash Functions for GPU Rendering" (JCGT 2020).
pub fn pcg(seed: u32) -> u32 {
    let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    word >> 22 ^ word
}

/// Returns a number from 0 to 1, without 1, from the upper bits of `bits`.
#[cfg(feature = "edit")]
pub(crate) fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}
