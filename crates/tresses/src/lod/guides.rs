//! The order of guides: those that are simulated at a level of detail, and whom the others follow.
//!
//! Each guide is as far as it can be from those before it (farthest-point sampling; Gonzalez, "Clustering to minimize the
//! maximum intercluster distance", 1985): the first `k` then leave no guide farther from one of them than any `k` could by
//! half. How far two guides are apart is measured where they rest, at root, middle and tip. A guide that is not simulated
//! goes with the nearest among the first of half its place or more in that order: as guides are left out, the one that it
//! goes with stays the same until that is left out itself. How it goes is `simulate::lead`.
//!
//! Where strands are guides themselves the order is that of the strands ([`super::arrange`]), of which every prefix is an
//! even sample; so it is for more guides than can be compared with each other.

use crate::{
    Context, Result,
    groom::{BoundStrands, Groom, Guides},
    simulate::Tree,
    strands::Guide,
};
use glam::Vec3;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Farthest points are sought among so many guides at most: the search compares each with each.
const COMPARED: usize = 2048;
/// Among so many earlier guides the nearest is sought.
const NEAREST_OF: usize = 1024;
/// The fewest guides that are simulated: with fewer, locks on both sides of a head would swing as one.
pub const LEAST_GUIDES: u32 = 12;

/// Guides in the order in which levels of detail leave them out, made when one first does.
#[derive(Debug)]
pub(crate) struct GuideOrder {
    /// Of each guide at rest: root, middle, tip, metres.
    places: Vec<[Vec3; 3]>,
    /// What the GPU knows of each.
    infos: Vec<Guide>,
    /// The order given by the strands, for guides that are not ordered by distance.
    strands: Vec<u32>,
    made: OnceLock<Made>,
    tree: Mutex<Option<Tree>>,
}

/// The order, and what is known of each of its prefixes.
#[derive(Debug)]
pub(crate) struct Made {
    /// For each place the guide that has it, and the place of the one that it goes with.
    pub tree: Vec<[u32; 2]>,
    /// `reach[k - 1]`: how far a guide is at most from the nearest that is simulated where `k` are, metres.
    pub reach: Vec<f32>,
}

impl GuideOrder {
    /// Of the guides of `groom`; its strands are in the order in which they are drawn.
    pub fn new(guides: &Guides, infos: Vec<Guide>, firsts: impl Iterator<Item = u32>) -> Self {
        let n = guides.vertex_count as usize;
        let place = |i: usize| [0, (n - 1) / 2, n - 1].map(|j| guides.positions[i * n + j]);
        let places: Vec<_> = (0..guides.len()).map(place).collect();
        let mut seen = vec![false; places.len()];
        let mut strands: Vec<u32> = firsts
            .filter(|i| seen.get_mut(*i as usize).is_some_and(|seen| !std::mem::replace(seen, true)))
            .collect();
        strands.extend((0..places.len() as u32).filter(|i| !seen[*i as usize]));
        Self { places, infos, strands, made: OnceLock::new(), tree: Mutex::default() }
    }

    /// The order.
    pub fn get(&self) -> &Made {
        self.made.get_or_init(|| {
            if self.places.len() <= COMPARED { self.by_distance() } else { self.by_strands() }
        })
    }

    /// The order on the GPU, and in `info`, which has what is known of each guide: for all heads with this groom.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn tree(&self, context: &Context, info: &wgpu::Buffer) -> Result<Tree> {
        let Context { queue, .. } = context;
        // What a panic leaves behind is whole.
        let mut tree = self.tree.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(tree) = &*tree {
            return Ok(tree.clone());
        }
        let made = self.get();
        let infos = self.infos.iter().zip(&made.tree);
        let infos: Vec<_> = infos
            .map(|(info, [guide, _])| Guide { flags: info.flags & 0xff | guide << 8, ..*info })
            .collect();
        let new = Tree::new(context, &made.tree)?;
        queue.write_buffer(info, 0, bytemuck::cast_slice(&infos));
        *tree = Some(new.clone());
        Ok(new)
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.tree.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map_or(0, Tree::bytes)
    }

    fn apart(&self, a: u32, b: u32) -> f32 {
        let (a, b) = (&self.places[a as usize], &self.places[b as usize]);
        (0..3).map(|i| a[i].distance_squared(b[i])).fold(0.0, f32::max)
    }

    fn by_distance(&self) -> Made {
        let count = self.places.len();
        let mut order = Vec::with_capacity(count);
        let mut left = vec![f32::INFINITY; count];
        let mut next = self.strands[0];
        let mut reach = Vec::with_capacity(count);
        for _ in 0..count {
            order.push(next);
            left[next as usize] = -1.0;
            for (i, far) in left.iter_mut().enumerate().filter(|(_, far)| **far >= 0.0) {
                *far = far.min(self.apart(i as u32, next));
            }
            let farthest = left.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
            let (i, far) = farthest.map_or((0, 0.0), |(i, far)| (i, *far));
            reach.push(far.max(0.0).sqrt());
            next = i as u32;
        }
        self.with(order, Some(reach))
    }

    fn by_strands(&self) -> Made {
        self.with(self.strands.clone(), None)
    }

    /// Finds whom each goes with in that order.
    fn with(&self, order: Vec<u32>, reach: Option<Vec<f32>>) -> Made {
        let nearest = |k: usize| {
            // The first of an octave that ends at or before it.
            let among = if k == 0 { 0 } else { 1usize << k.ilog2() };
            let apart = |q: &usize| self.apart(order[k], order[*q]);
            (0..among.min(NEAREST_OF)).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
        };
        let tree: Vec<_> = (0..order.len()).map(|k| [order[k], nearest(k) as u32]).collect();
        let reach = reach.unwrap_or_else(|| {
            // Of each octave, and between them as a power of the number.
            let mut worst = vec![0f32; order.len()];
            for k in (1..order.len()).rev() {
                let own = self.apart(order[k], order[tree[k][1] as usize]).sqrt();
                let octave = (1usize << k.ilog2()) - 1;
                worst[octave] = worst[octave].max(own);
            }
            let mut so_far = 0.0;
            for worst in worst.iter_mut().rev() {
                so_far = worst.max(so_far);
                *worst = so_far;
            }
            worst
        });
        Made { tree, reach }
    }

    /// How many are to be simulated for the others to be no farther from whom they go with than `reach` metres.
    pub fn enough(&self, reach: f32) -> u32 {
        let count = self.places.len() as u32;
        if reach <= 0.0 {
            return count;
        }
        let made = self.get();
        let enough = made.reach.partition_point(|far| *far > reach) as u32 + 1;
        enough.max(LEAST_GUIDES).min(count)
    }
}

/// The order of the guides of `groom`, whose strands are `arranged`.
pub(crate) fn order(groom: &Groom, infos: Vec<Guide>, arranged: &BoundStrands) -> GuideOrder {
    GuideOrder::new(&groom.guides, infos, arranged.bindings.iter().map(|binding| binding.guides[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::pcg;

    /// Guides that hang from a square, at random.
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
    fn every_guide_goes_with_one_before_it_that_is_near() {
        for count in [1, 2, 300, 2500] {
            let order = guides(count);
            let made = order.get();
            let mut all: Vec<_> = made.tree.iter().map(|[guide, _]| *guide).collect();
            all.sort_unstable();
            assert!(all.iter().enumerate().all(|(i, guide)| i as u32 == *guide), "{count}");
            for (k, [_, with]) in made.tree.iter().enumerate().skip(1) {
                assert!((*with as usize) < k, "{count}: {k} {with}");
            }
            assert!(made.reach.windows(2).all(|w| w[0] >= w[1]), "{count}: more are never worse");
        }
        // An even sample of a unit square by 64: no farther than its diagonal over 8 or so; at random twice that.
        let order = guides(300);
        assert!(order.get().reach[63] < 0.14, "{}", order.get().reach[63]);
        // As few as reach that far.
        let enough = order.enough(0.14) as usize;
        let reach = &order.get().reach;
        assert!(reach[enough - 1] <= 0.14 && reach[enough - 2] > 0.14, "{enough}");
        assert_eq!([order.enough(0.0), order.enough(10.0)], [300, LEAST_GUIDES]);
        assert!(guides(2500).enough(0.2) < 300, "{}", guides(2500).enough(0.2));
    }
}
