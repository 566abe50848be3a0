//! CPU reference of `ramp.wesl`: values as colors.

use glam::Vec3;

/// Returns the color of `t` in 0..1, linear sRGB. In Oklab (Ottosson 2020), the lightness of the ramp rises evenly from
/// 0.24 to 0.92, and its hue goes from violet over blue and green to yellow. Equal steps of the value are about equally
/// visible, even without color.
pub fn ramp(t: f32) -> Vec3 {
    let t = t.clamp(0.0, 1.0);
    let hue = (305.0 - 200.0 * t).to_radians();
    // As saturated as sRGB allows along the whole ramp.
    let chroma = 0.092 + 0.09 * t.powi(4);
    oklab(Vec3::new(0.24 + 0.68 * t, chroma * hue.cos(), chroma * hue.sin()))
}

/// Converts Oklab to linear sRGB.
fn oklab(c: Vec3) -> Vec3 {
    let cone = |a: f32, b: f32| {
        let root = c.x + a * c.y + b * c.z;
        root * root * root
    };
    let (l, m, s) = (
        cone(0.396_337_78, 0.215_803_76),
        cone(-0.105_561_346, -0.063_854_17),
        cone(-0.089_484_18, -1.291_485_5),
    );
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the CIE lightness of linear sRGB, which the ramp is not based on.
    fn lightness(c: Vec3) -> f32 {
        let y = c.dot(Vec3::new(0.2126, 0.7152, 0.0722));
        if y > 0.008_856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
    }

    /// Returns the smallest and the largest rise of lightness over steps of 1/32.
    fn rises(map: impl Fn(f32) -> Vec3) -> (f32, f32) {
        let rises = (0..32).map(|i| lightness(map((i + 1) as f32 / 32.0)) - lightness(map(i as f32 / 32.0)));
        rises.fold((f32::MAX, f32::MIN), |(lo, hi), r| (lo.min(r), hi.max(r)))
    }

    #[test]
    fn ramp_stays_in_srgb_and_rises_evenly() {
        for i in 0..=256 {
            let c = ramp(i as f32 / 256.0);
            assert!(c.min_element() > -1e-3 && c.max_element() < 1.0, "{i}: {c}");
        }
        let (least, greatest) = rises(ramp);
        assert!(least > 0.0 && greatest < 2.0 * least, "{least} {greatest}");
        // The lightness of a rainbow is not monotonic.
        let rainbow = |t: f32| {
            Vec3::new((t - 0.75).abs(), (t - 0.5).abs(), (t - 0.25).abs())
                .map(|d| (1.5 - 4.0 * d).clamp(0.0, 1.0))
        };
        assert!(rises(rainbow).0 < 0.0);
    }
}
