//! Light of one lamp, split by how often it was scattered. In totals, errors of the two parts can cancel.

use super::{Row, tones::Tones};
use serde::Serialize;

/// Light scattered once and light scattered several times, each as a ratio to the reference; `None` where the
/// reference has almost none.
#[derive(Debug, PartialEq, Serialize)]
pub struct ScatteringOrders {
    /// Name of the image of the light alone.
    pub name: String,
    /// Fraction of the reference's light that was scattered once.
    #[serde(rename = "share")]
    pub once_fraction: f64,
    /// Luminance of light scattered once.
    pub once: Option<f64>,
    /// Luminance of light scattered several times.
    pub several: Option<f64>,
    /// The same in red, green and blue.
    pub channels: [Option<f64>; 3],
}

impl ScatteringOrders {
    /// Part of all light below which a ratio says nothing.
    const MIN_FRACTION: f64 = 0.005;

    /// Compares images of all light and of light scattered once.
    pub(super) fn new(all: &Row, once: &Row) -> Self {
        let ratio = |own: f64, other: f64, all: f64| (other > Self::MIN_FRACTION * all).then(|| own / other);
        let several = |of: &dyn Fn(&Tones) -> f64| {
            let (own, other) =
                (of(&all.rendered) - of(&once.rendered), of(&all.reference) - of(&once.reference));
            ratio(own, other, of(&all.reference))
        };
        let luminance = all.reference.luminance;
        Self {
            name: all.name.clone(),
            once_fraction: once.reference.luminance / luminance.max(1e-12),
            once: ratio(once.rendered.luminance, once.reference.luminance, luminance),
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

    fn row(ours: Tones, reference: Tones) -> Row {
        Row { name: "a".into(), difference: None, rendered: ours, reference }
    }

    #[test]
    fn opposite_errors_show_although_the_total_is_right() {
        let all = row(tones([4.0, 3.0, 2.0], 3.0), tones([4.0, 3.0, 2.0], 3.0));
        let once = row(tones([2.5, 1.5, 1.0], 1.5), tones([1.0, 1.0, 1.0], 1.0));
        let found = ScatteringOrders::new(&all, &once);
        assert_eq!((found.once, found.several), (Some(1.5), Some(0.75)));
        assert_eq!(found.channels, [Some(0.5), Some(0.75), Some(1.0)]);
        assert!((found.once_fraction - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn ratios_to_almost_nothing_are_absent() {
        let all = tones([1.0, 1.0, 1e-3], 1.0);
        let once = tones([0.0, 0.9999, 0.0], 0.9999);
        let found = ScatteringOrders::new(&row(all.clone(), all), &row(once.clone(), once));
        assert_eq!((found.several, found.channels), (None, [Some(1.0), None, Some(1.0)]));
    }
}
