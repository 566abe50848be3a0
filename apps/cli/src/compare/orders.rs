//! Light of one lamp, split by how often it was scattered. In totals, errors of the two parts can cancel.

use super::tones::Tones;
use serde::Serialize;

/// Light scattered once and light scattered several times, each as a ratio to the reference; `None` where the
/// reference has almost none.
#[derive(Debug, PartialEq, Serialize)]
pub struct ScatteringOrders {
    /// Name of the image of the light alone.
    pub name: String,
    /// Fraction of the reference's light that was scattered once.
    pub share: f64,
    /// Luminance of light scattered once.
    pub once: Option<f64>,
    /// Luminance of light scattered several times.
    pub several: Option<f64>,
    /// The same in red, green and blue.
    pub channels: [Option<f64>; 3],
}

impl ScatteringOrders {
    /// Part of all light below which a ratio says nothing.
    const LEAST: f64 = 0.005;

    /// Compares our images with the reference's, each as (all light, light scattered once).
    pub fn new(name: &str, ours: (&Tones, &Tones), reference: (&Tones, &Tones)) -> Self {
        let ratio = |own: f64, other: f64, all: f64| (other > Self::LEAST * all).then(|| own / other);
        let several = |of: &dyn Fn(&Tones) -> f64| {
            let [own, other] = [ours, reference].map(|(all, once)| of(all) - of(once));
            ratio(own, other, of(reference.0))
        };
        let luminance = reference.0.luminance;
        Self {
            name: name.to_owned(),
            share: reference.1.luminance / luminance.max(1e-12),
            once: ratio(ours.1.luminance, reference.1.luminance, luminance),
            several: several(&|tones| tones.luminance),
            channels: [0, 1, 2].map(|c| several(&|tones| tones.rgb[c])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tones(rgb: [f64; 3], luminance: f64) -> Tones {
        Tones { rgb, luminance, ..Default::default() }
    }

    #[test]
    fn opposite_errors_show_although_the_total_is_right() {
        let reference = (&tones([4.0, 3.0, 2.0], 3.0), &tones([1.0, 1.0, 1.0], 1.0));
        let ours = (&tones([4.0, 3.0, 2.0], 3.0), &tones([2.5, 1.5, 1.0], 1.5));
        let found = ScatteringOrders::new("a_key", ours, reference);
        assert_eq!((found.once, found.several), (Some(1.5), Some(0.75)));
        assert_eq!(found.channels, [Some(0.5), Some(0.75), Some(1.0)]);
        assert!((found.share - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn ratios_to_almost_nothing_are_absent() {
        let all = tones([1.0, 1.0, 1e-3], 1.0);
        let once = tones([0.0, 0.9999, 0.0], 0.9999);
        let found = ScatteringOrders::new("a_rim", (&all, &once), (&all, &once));
        assert_eq!((found.several, found.channels), (None, [Some(1.0), None, Some(1.0)]));
    }
}
