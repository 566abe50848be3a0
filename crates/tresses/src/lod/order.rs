//! The order of strands: every prefix is an even sample of all strands.

use crate::{groom::BoundStrands, math::hash::pcg};

/// Ratio of the strand counts of successive buckets. A bucket fades in as a whole.
pub const BUCKET_RATIO: f64 = 1.189_207_115; // 2^(1/4)

/// Returns the strand counts at which buckets end, ascending; the last is `count`. The first bucket has at most
/// `max_first` strands and is always drawn.
pub fn buckets(count: u32, max_first: u32) -> Vec<u32> {
    let mut ends = vec![count];
    let mut end = f64::from(count);
    while end > f64::from(max_first.max(1)) {
        end /= BUCKET_RATIO;
        let next = end.ceil() as u32;
        if ends.last().is_some_and(|last| next < *last) {
            ends.push(next);
        }
    }
    ends.reverse();
    ends
}

/// Reorders `strands` so that level of detail can drop them from the end. Strands are first sorted by guide, and by
/// hash within a guide. The sorted places are then taken in van der Corput order, so that for any `k` the first `k`
/// strands are spread evenly over all guides. Within a bucket (see `buckets`), which appears as a whole, strands stay
/// sorted by guide, so that neighbors in memory read the same guide samples. The order depends only on the strands and
/// is idempotent.
pub fn arrange(strands: &mut BoundStrands) {
    let order = order(strands);
    let n = strands.vertex_count as usize;
    strands.strands = order.iter().map(|i| strands.strands[*i as usize]).collect();
    strands.bindings = order.iter().map(|i| strands.bindings[*i as usize]).collect();
    let vertices = |i: &u32| &strands.rest[*i as usize * n..(*i as usize + 1) * n];
    strands.rest = order.iter().flat_map(vertices).copied().collect();
}

/// Returns for each place in the order of [`arrange`] the index of its strand.
pub fn order(strands: &BoundStrands) -> Vec<u32> {
    let count = strands.len() as u32;
    let key = |i: &u32| {
        let binding = &strands.bindings[*i as usize];
        let origin = binding.origin.to_array().iter().fold(0, |hash, x| pcg(hash ^ x.to_bits()));
        // Equal strands keep their order: the sort is stable.
        (binding.guides[0], pcg(origin ^ strands.strands[*i as usize].seed), origin)
    };
    let mut sorted: Vec<u32> = (0..count).collect();
    sorted.sort_by_cached_key(key);
    let mut slots: Vec<u32> = (0..count).collect();
    slots.sort_unstable_by_key(|slot| slot.reverse_bits());
    let mut begin = 0;
    for end in buckets(count, 1) {
        slots[begin as usize..end as usize].sort_unstable();
        begin = end;
    }
    slots.iter().map(|slot| sorted[*slot as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{groom::Influence, strands::Strand};
    use glam::Vec3;

    /// 2,000 strands on 100 guides, the first guides with the most.
    fn strands() -> BoundStrands {
        let mut strands = BoundStrands::new(2);
        for i in 0..2000u32 {
            let x = (i as f32 / 2000.0).powi(2);
            let influence = Influence { guide: (x * 100.0) as u32, weight: 1.0, scale: 1.0 };
            let root = Vec3::new(x, pcg(i) as f32 * 1e-10, 0.0);
            let strand = Strand { radius: 1e-4, seed: i, root_color: 0, tip_color: 0 };
            strands.push(strand, &[root, root + Vec3::Y], &[1.0; 2], &[influence]);
        }
        strands
    }

    /// Largest difference between the cumulative distributions over guides of the first `k` strands and of all strands.
    fn unevenness(strands: &BoundStrands, k: usize) -> f32 {
        let share = |k: usize, g: u32| {
            strands.bindings[..k].iter().filter(|b| b.guides[0] < g).count() as f32 / k as f32
        };
        (0..100).map(|g| (share(k, g) - share(strands.len(), g)).abs()).fold(0.0, f32::max)
    }

    #[test]
    fn every_prefix_is_an_even_sample() {
        let mut arranged = strands();
        assert!(unevenness(&arranged, 500) > 0.2, "as it comes it is none");
        arrange(&mut arranged);
        for k in buckets(2000, 16) {
            // A random sample would be off by about 0.8 / sqrt(k).
            let most = 0.05f32.max(3.0 / k as f32);
            assert!(unevenness(&arranged, k as usize) < most, "{k}: {}", unevenness(&arranged, k as usize));
        }
        let mut again = arranged.clone();
        arrange(&mut again);
        assert_eq!(again, arranged);
        let mut seeds: Vec<_> = arranged.strands.iter().map(|s| s.seed).collect();
        seeds.sort_unstable();
        assert!(seeds.iter().enumerate().all(|(i, seed)| i as u32 == *seed));
    }

    #[test]
    fn buckets_grow_by_a_ratio() {
        for count in [1, 2, 7, 100, 16_000, 1_000_000] {
            let ends = buckets(count, 128);
            assert_eq!(*ends.last().unwrap(), count);
            assert!(ends[0] <= 128 && ends.windows(2).all(|w| w[0] < w[1]), "{ends:?}");
            let steep = |w: &[u32]| f64::from(w[1]) / f64::from(w[0]) > BUCKET_RATIO + 0.02;
            assert!(!ends.windows(2).any(|w| w[0] > 100 && steep(w)), "{ends:?}");
        }
    }
}
