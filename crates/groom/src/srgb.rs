//! Transfer function of sRGB (IEC 61966-2-1), for values from 0 to 1.

/// Decodes an sRGB value to linear.
pub fn linear(v: f32) -> f32 {
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Encodes a linear value as sRGB. Inverse of [`linear`].
pub fn encoded(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_round_trip() {
        for byte in 0..=255u8 {
            let back = 255.0 * encoded(linear(f32::from(byte) / 255.0));
            assert!((back - f32::from(byte)).abs() < 0.01, "{byte}: {back}");
        }
    }
}
