//! Digest in front of every sample, by which readers recognize equal samples: 128-bit MurmurHash3 (Austin Appleby,
//! public domain), seeded with the size of a number.

const C1: u64 = 0x87c3_7b91_1142_53d5;
const C2: u64 = 0x4cf5_ad43_2745_937f;

/// Returns the digest of `bytes`, whose numbers have `size` bytes each.
pub(super) fn digest(bytes: &[u8], size: u32) -> [u8; 16] {
    let (mut a, mut b) = (u64::from(size), u64::from(size));
    let first = |k: u64| k.wrapping_mul(C1).rotate_left(31).wrapping_mul(C2);
    let second = |k: u64| k.wrapping_mul(C2).rotate_left(33).wrapping_mul(C1);
    let (blocks, tail) = bytes.as_chunks::<16>();
    let halves = |block: &[u8; 16]| {
        let bits = u128::from_le_bytes(*block);
        (bits as u64, (bits >> 64) as u64)
    };
    for block in blocks {
        let (low, high) = halves(block);
        a = (a ^ first(low)).rotate_left(27).wrapping_add(b).wrapping_mul(5).wrapping_add(0x52dc_e729);
        b = (b ^ second(high)).rotate_left(31).wrapping_add(a).wrapping_mul(5).wrapping_add(0x3849_5ab5);
    }
    let mut last = [0; 16];
    last[..tail.len()].copy_from_slice(tail);
    let (low, high) = halves(&last);
    // The last block is padded with zeros, whose products are 0 and leave the state unchanged.
    b ^= second(high);
    a ^= first(low);
    let length = bytes.len() as u64;
    (a, b) = (a ^ length, b ^ length);
    a = a.wrapping_add(b);
    b = b.wrapping_add(a);
    (a, b) = (mix(a), mix(b));
    a = a.wrapping_add(b);
    b = b.wrapping_add(a);
    ((u128::from(b) << 64) | u128::from(a)).to_le_bytes()
}

fn mix(mut k: u64) -> u64 {
    k = (k ^ (k >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    k = (k ^ (k >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    k ^ (k >> 33)
}

#[cfg(test)]
mod tests {
    use super::digest;

    #[test]
    fn digests_match_published_values() {
        // Published values of the 128-bit variant for x64, seed 0.
        let hex = |text: &str| {
            digest(text.as_bytes(), 0).iter().rev().map(|b| format!("{b:02x}")).collect::<String>()
        };
        assert_eq!(hex(""), "0".repeat(32));
        // `h1` is the lower half.
        assert_eq!(hex("The quick brown fox jumps over the lazy dog"), "7a433ca9c49a9347e34bbc7bbc071b6c");
        assert_ne!(digest(b"a", 1), digest(b"a", 4));
        assert_ne!(digest(b"abcdefghijklmnopq", 1), digest(b"abcdefghijklmnopr", 1));
    }
}
