//! Sample times.

use super::{
    Source,
    ogawa::{Data, Reader},
};
use crate::error::Result;

/// Times of a property's samples, seconds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sampling {
    /// Period after which the stored times repeat, seconds; above [`ACYCLIC`] they do not repeat.
    cycle: f64,
    stored: Vec<f64>,
}

/// Threshold above which a cycle means “acyclic”. Files store a fraction of the largest `f64` for it.
const ACYCLIC: f64 = 1e300;

impl Sampling {
    /// Returns the time of sample `i`, seconds.
    pub fn time(&self, i: u32) -> f64 {
        let n = self.stored.len().max(1);
        let cycles = i as usize / n;
        if self.cycle > ACYCLIC {
            return self.stored.get(i as usize).or(self.stored.last()).copied().unwrap_or(0.0);
        }
        self.stored.get(i as usize % n).copied().unwrap_or(0.0) + self.cycle * cycles as f64
    }

    /// Returns which of `count` samples is nearest to `time`; the earlier one of a tie.
    pub fn nearest(&self, time: f64, count: u32) -> u32 {
        // Sample times never decrease.
        let (mut lo, mut hi) = (0, count);
        while lo < hi {
            let midpoint = lo + (hi - lo) / 2;
            if self.time(midpoint) < time {
                lo = midpoint + 1;
            } else {
                hi = midpoint;
            }
        }
        let after = lo.min(count.saturating_sub(1));
        let before = after.saturating_sub(1);
        let far = |i: u32| (self.time(i) - time).abs();
        if far(before) <= far(after) { before } else { after }
    }
}

/// Reads all samplings of a file. Properties refer to them by index.
pub(super) fn read(source: &Source, data: Data) -> Result<Vec<Sampling>> {
    let mut reader = Reader::new(source, data, "the time samplings");
    let mut all = Vec::new();
    while !reader.done() {
        reader.number(4)?;
        let cycle = reader.f64()?;
        let count = reader.number(4)?;
        let bytes = reader.bytes((count as usize).saturating_mul(8))?;
        let stored: Vec<f64> = bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        if stored.is_empty() || !cycle.is_finite() || stored.iter().any(|time| !time.is_finite()) {
            return reader.problem("a time sampling has no times, or times that are not finite");
        }
        all.push(Sampling { cycle, stored });
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_uniform_cyclic_and_listed_times() {
        let uniform = Sampling { cycle: 0.25, stored: vec![1.0] };
        assert_eq!((uniform.time(0), uniform.time(4)), (1.0, 2.0));
        assert_eq!([0.0, 1.1, 1.13, 1.6, 99.0].map(|t| uniform.nearest(t, 5)), [0, 0, 1, 2, 4]);
        let shutter = Sampling { cycle: 1.0, stored: vec![0.0, 0.25] };
        assert_eq!([0, 1, 2, 3].map(|i| shutter.time(i)), [0.0, 0.25, 1.0, 1.25]);
        assert_eq!(shutter.nearest(1.2, 4), 3);
        let listed = Sampling { cycle: f64::MAX / 32.0, stored: vec![0.0, 3.0, 4.0] };
        assert_eq!((listed.time(1), listed.time(9)), (3.0, 4.0));
        assert_eq!((listed.nearest(1.4, 3), listed.nearest(1.6, 3)), (0, 1));
        assert_eq!(listed.nearest(0.0, 0), 0);
    }
}
