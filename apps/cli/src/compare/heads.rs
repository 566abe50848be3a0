//! Light on each head of a crowd.

use super::metrics::{Linear, mean};
use serde::Serialize;

/// Mean luminance of the hair of one head, ours and the reference's.
#[derive(Debug, PartialEq, Serialize)]
pub struct HeadLuminance {
    /// Name of the view.
    pub name: String,
    /// Number of the head, from 1.
    pub head: usize,
    /// Number of pixels.
    pub pixels: usize,
    /// Our mean luminance, linear.
    #[serde(rename = "ours")]
    pub rendered: f64,
    /// The reference's.
    pub reference: f64,
}

impl HeadLuminance {
    /// Compares the heads of a view. `owners` has the number of the head of each pixel with hair, and 0 elsewhere.
    pub fn of_view(name: &str, owners: &[u8], rendered: &Linear, reference: &Linear) -> Vec<Self> {
        let count = owners.iter().copied().max().unwrap_or(0);
        (1..=count)
            .map(|head| {
                let pixels: Vec<_> = (0..owners.len()).filter(|i| owners[*i] == head).collect();
                let light = |image: &Linear| mean(pixels.iter().map(|i| image.luminance(*i)));
                Self {
                    name: name.to_owned(),
                    head: head.into(),
                    pixels: pixels.len(),
                    rendered: light(rendered),
                    reference: light(reference),
                }
            })
            .collect()
    }

    /// Returns our luminance over the reference's, unless that is black or no pixel shows the head.
    pub fn ratio(&self) -> Option<f64> {
        (self.reference > 0.0).then(|| self.rendered / self.reference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_compared_separately() {
        let image = |light: [f32; 5]| Linear { width: 5, pixels: light.map(|light| [light; 3]).to_vec() };
        // Two pixels of the first head, none of the second, one of the third, which is black in the reference.
        let owners = [0, 1, 1, 3, 0];
        let rows = HeadLuminance::of_view(
            "crowd",
            &owners,
            &image([9.0, 1.0, 2.0, 4.0, 9.0]),
            &image([7.0, 2.0, 4.0, 0.0, 7.0]),
        );
        let found: Vec<_> = rows.iter().map(|row| (row.head, row.pixels)).collect();
        assert_eq!(found, [(1, 2), (2, 0), (3, 1)]);
        let ratios: Vec<_> = rows.iter().map(HeadLuminance::ratio).collect();
        assert!(ratios[0].is_some_and(|ratio| (ratio - 0.5).abs() < 1e-6), "{ratios:?}");
        assert_eq!(ratios[1..], [None, None]);
    }
}
