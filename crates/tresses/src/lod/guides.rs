//! The order of guides for levels of detail: the first ones are simulated, the others follow them.
//!
//! Each guide is as far as possible from all earlier ones (farthest-point sampling; Gonzalez, "Clustering to minimize
//! the maximum intercluster distance", 1985). The largest distance of any guide from the first `k` is then at most
//! twice the optimum for `k` guides. The distance of two guides is measured at rest, at root, middle and tip. Guide
//! number `k` follows the nearest of the first `2^⌊log₂ k⌋` guides, so the guide that it follows stays the same until
//! that guide is dropped as well. `simulate::lead` moves the followers.
//!
//! If strands are their own guides, the order is the strands' ([`super::arrange`]), of which every prefix is an even
//! sample. The same holds if there are too many guides to compare in pairs.

use crate::{
    Context, Result,
    groom::{BoundStrands, Guides},
    simulate::Tree,
    strands::Guide,
};
use glam::Vec3;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// Maximum number of guides for farthest-point sampling, which compares all pairs.
const COMPARED: usize = 2048;
/// Maximum number of earlier guides among which the nearest is searched.
const NEAREST_OF: usize = 1024;
/// Minimum number of simulated guides. With fewer, locks on both sides of a head would swing as one.
pub const MIN_GUIDES: u32 = 12;

/// Guides in the order in which levels of detail drop them, computed when first needed.
#[derive(Debug)]
pub(crate) struct GuideOrder {
    /// Rest positions of each guide's root, middle and tip, meters.
    positions: Vec<[Vec3; 3]>,
    /// The order given by the strands, for guides that are not ordered by distance.
    strands: Vec<u32>,
    prefixes: OnceLock<GuidePrefixes>,
    /// GPU data of each guide, and of the order once it is needed.
    data: Mutex<(Vec<Guide>, Option<Tree>)>,
}

/// The order, and the distances for each prefix.
#[derive(Debug)]
pub(crate) struct GuidePrefixes {
    /// For each place: the guide, and the place of the guide that it follows.
    pub tree: Vec<[u32; 2]>,
    /// `reach[k - 1]`: largest distance of a guide from the one that it follows, if `k` guides are simulated, meters.
    pub max_distances: Vec<f32>,
}

impl GuideOrder {
    /// Creates the order of `guides`. `firsts` are the first guides of the strands in drawing order.
    pub fn new(guides: &Guides, infos: Vec<Guide>, firsts: impl Iterator<Item = u32>) -> Self {
        let n = guides.vertex_count as usize;
        let positions_of = |i: usize| [0, (n - 1) / 2, n - 1].map(|j| guides.positions[i * n + j]);
        let positions: Vec<_> = (0..guides.len()).map(positions_of).collect();
        let mut added = vec![false; positions.len()];
        let mut strands: Vec<u32> = firsts
            .filter(|i| added.get_mut(*i as usize).is_some_and(|is_added| !std::mem::replace(is_added, true)))
            .collect();
        strands.extend((0..positions.len() as u32).filter(|i| !added[*i as usize]));
        Self { positions, strands, prefixes: OnceLock::new(), data: Mutex::new((infos, None)) }
    }

    /// Returns the order.
    pub fn get(&self) -> &GuidePrefixes {
        self.prefixes.get_or_init(|| {
            if self.positions.len() <= COMPARED { self.by_distance() } else { self.by_strands() }
        })
    }

    /// Uploads the order, and writes it into `info`, the GPU data of the guides. All heads with this groom share it.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn tree(&self, context: &Context, info: &wgpu::Buffer) -> Result<Tree> {
        let mut data = self.data();
        if let (_, Some(tree)) = &*data {
            return Ok(tree.clone());
        }
        let tree = Tree::new(context, &self.get().tree)?;
        data.1 = Some(tree.clone());
        self.write(context, &data.0, info);
        Ok(tree)
    }

    /// Replaces the data of the guides, which `info` has on the GPU.
    pub(crate) fn set_infos(&self, context: &Context, infos: Vec<Guide>, info: &wgpu::Buffer) {
        let mut data = self.data();
        data.0 = infos;
        if data.1.is_some() {
            self.write(context, &data.0, info);
        }
    }

    /// Writes `infos` with the order.
    fn write(&self, context: &Context, infos: &[Guide], info: &wgpu::Buffer) {
        let ordered = infos.iter().zip(&self.get().tree);
        let ordered: Vec<_> = ordered
            .map(|(info, [guide, _])| Guide { flags: info.flags & 0xff | guide << 8, ..*info })
            .collect();
        context.queue.write_buffer(info, 0, bytemuck::cast_slice(&ordered));
    }

    fn data(&self) -> MutexGuard<'_, (Vec<Guide>, Option<Tree>)> {
        // The value stays consistent if a holder panics.
        self.data.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the GPU memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.data().1.as_ref().map_or(0, Tree::bytes)
    }

    fn distance_squared(&self, a: u32, b: u32) -> f32 {
        let (a, b) = (&self.positions[a as usize], &self.positions[b as usize]);
        (0..3).map(|i| a[i].distance_squared(b[i])).fold(0.0, f32::max)
    }

    fn by_distance(&self) -> GuidePrefixes {
        let count = self.positions.len();
        let mut order = Vec::with_capacity(count);
        let mut left = vec![f32::INFINITY; count];
        let mut next = self.strands[0];
        let mut max_distances = Vec::with_capacity(count);
        for _ in 0..count {
            order.push(next);
            left[next as usize] = -1.0;
            for (i, far) in left.iter_mut().enumerate().filter(|(_, far)| **far >= 0.0) {
                *far = far.min(self.distance_squared(i as u32, next));
            }
            let candidate = left.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
            let (i, far) = candidate.map_or((0, 0.0), |(i, far)| (i, *far));
            max_distances.push(far.max(0.0).sqrt());
            next = i as u32;
        }
        self.with(order, Some(max_distances))
    }

    fn by_strands(&self) -> GuidePrefixes {
        self.with(self.strands.clone(), None)
    }

    /// Finds the guide that each one follows in that order.
    fn with(&self, order: Vec<u32>, max_distances: Option<Vec<f32>>) -> GuidePrefixes {
        let nearest = |k: usize| {
            // The guides before the octave that contains `k`.
            let among = if k == 0 { 0 } else { 1usize << k.ilog2() };
            let distance = |q: &usize| self.distance_squared(order[k], order[*q]);
            (0..among.min(NEAREST_OF)).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let tree: Vec<_> = (0..order.len()).map(|k| [order[k], nearest(k) as u32]).collect();
        let max_distances = max_distances.unwrap_or_else(|| {
            // With `k` guides, the guides with index `k` or higher follow.
            let mut max_distances = vec![0f32; order.len()];
            for k in (1..order.len()).rev() {
                let own = self.distance_squared(order[k], order[tree[k][1] as usize]).sqrt();
                max_distances[k - 1] = max_distances[k].max(own);
            }
            max_distances
        });
        GuidePrefixes { tree, max_distances }
    }

    /// Returns the number of guides to simulate so that the others are at most `reach` meters from the ones that they
    /// follow.
    pub fn enough(&self, max_distance: f32) -> u32 {
        let count = self.positions.len() as u32;
        if max_distance <= 0.0 {
            return count;
        }
        let prefixes = self.get();
        let enough = prefixes.max_distances.partition_point(|far| *far > max_distance) as u32 + 1;
        enough.max(MIN_GUIDES).min(count)
    }
}

/// Returns the order of `guides`, whose strands are `arranged`.
pub(crate) fn order(guides: &Guides, infos: Vec<Guide>, arranged: &BoundStrands) -> GuideOrder {
    GuideOrder::new(guides, infos, arranged.bindings.iter().map(|binding| binding.guides[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::pcg;

    /// Guides that hang from a square at random positions.
    fn guides(count: u32) -> GuideOrder {
        let at = |i: u32, k: u32| pcg(3 * i + k) as f32 / u32::MAX as f32;
        let mut guides = Guides { vertex_count: 3, ..Default::default() };
        for i in 0..count {
            let root = Vec3::new(at(i, 0), 0.0, at(i, 1));
            let curve: Vec<_> = (0..3).map(|j| root - Vec3::Y * 0.1 * j as f32).collect();
            guides.positions.extend(curve);
            guides.stiffness.push(1.0);
            guides.strands.push(1.0);
            guides.tip_pinned.push(false);
        }
        GuideOrder::new(&guides, vec![Guide::default(); count as usize], (0..count).map(|i| (i * 7) % count))
    }

    #[test]
    fn every_guide_follows_a_near_earlier_one() {
        for count in [1, 2, 300, 2500] {
            let order = guides(count);
            let made = order.get();
            let mut all: Vec<_> = made.tree.iter().map(|[guide, _]| *guide).collect();
            all.sort_unstable();
            assert!(all.iter().enumerate().all(|(i, guide)| i as u32 == *guide), "{count}");
            for (k, [_, with]) in made.tree.iter().enumerate().skip(1) {
                assert!((*with as usize) < k, "{count}: {k} {with}");
            }
            // With more guides than are compared, the reach is that of the guides that are followed.
            if count as usize > COMPARED {
                for simulated in [1, 100, 1500, 2047, 2400] {
                    let followers = made.tree.iter().skip(simulated);
                    let apart = |[guide, with]: &[u32; 2]| {
                        order.distance_squared(*guide, made.tree[*with as usize][0])
                    };
                    let farthest = followers.map(apart).fold(0.0, f32::max).sqrt();
                    assert_eq!(made.max_distances[simulated - 1], farthest, "{simulated}");
                }
            }
            assert!(made.max_distances.windows(2).all(|w| w[0] >= w[1]), "{count}: more are never worse");
        }
        // An even sample of a unit square by 64 points: at most about its diagonal over 8; at random twice that.
        let order = guides(300);
        assert!(order.get().max_distances[63] < 0.14, "{}", order.get().max_distances[63]);
        // The smallest number of guides with that reach.
        let enough = order.enough(0.14) as usize;
        let reach = &order.get().max_distances;
        assert!(reach[enough - 1] <= 0.14 && reach[enough - 2] > 0.14, "{enough}");
        assert_eq!([order.enough(0.0), order.enough(10.0)], [300, MIN_GUIDES]);
        assert!(guides(2500).enough(0.2) < 300, "{}", guides(2500).enough(0.2));
    }
}
