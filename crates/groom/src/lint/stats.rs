//! Minimum, median, 95th percentile and maximum.

/// How a set of numbers is spread.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Spread {
    /// The smallest.
    pub min: f32,
    /// The middle one; of an even count, the upper of the two.
    pub median: f32,
    /// 95 of 100 are at most this.
    pub p95: f32,
    /// The largest.
    pub max: f32,
}

impl Spread {
    /// Of the finite ones among `values`; `None` without any.
    pub fn of(values: impl IntoIterator<Item = f32>) -> Option<Self> {
        let mut values: Vec<f32> = values.into_iter().filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f32::total_cmp);
        let at = |share: f32| values.get((values.len() as f32 * share) as usize);
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
    fn of_a_hundred() {
        let s = Spread::of((1..=100).rev().map(|i| i as f32).chain([f32::NAN])).unwrap();
        assert_eq!(s, Spread { min: 1.0, median: 51.0, p95: 96.0, max: 100.0 });
        assert_eq!(Spread::of([]), None);
    }
}
