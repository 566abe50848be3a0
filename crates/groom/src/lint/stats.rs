//! Minimum, median, 95th percentile and maximum.

/// Distribution of a set of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Spread {
    /// Minimum.
    pub min: f32,
    /// Median; of an even count, the upper of the two middle values.
    pub median: f32,
    /// 95th percentile.
    pub p95: f32,
    /// Maximum.
    pub max: f32,
}

impl Spread {
    /// Returns the distribution of the finite `values`; `None` if there are none.
    pub fn of(values: impl IntoIterator<Item = f32>) -> Option<Self> {
        let mut values: Vec<f32> = values.into_iter().filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f32::total_cmp);
        let at = |fraction: f32| values.get((values.len() as f32 * fraction) as usize);
        Some(Self {
            min: *values.first()?,
            median: *at(0.5)?,
            p95: *at(0.95).or(values.last())?,
            max: *values.last()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Spread;

    #[test]
    fn spread_of_a_hundred_numbers() {
        let s = Spread::of((1..=100).rev().map(|i| i as f32).chain([f32::NAN])).unwrap();
        assert_eq!(s, Spread { min: 1.0, median: 51.0, p95: 96.0, max: 100.0 });
        assert_eq!(Spread::of([]), None);
    }
}
