//! Guide positions in blocks that versions of a groom share.

use crate::near::morton;
use glam::Vec3;
use std::{collections::BTreeMap, sync::Arc};

/// Guides per block.
pub const BLOCK: usize = 16;

/// Positions of all guides. A changed copy shares the blocks without changes. Guides of one block have roots near each
/// other, so that a stroke changes few blocks.
#[derive(Clone, Debug)]
pub struct GuideBlocks {
    vertex_count: usize,
    /// Place of each guide in the blocks, and the guide at each place.
    order: Arc<(Vec<u32>, Vec<u32>)>,
    blocks: Vec<Arc<[Vec3]>>,
}

impl PartialEq for GuideBlocks {
    /// Whether both are the same memory.
    fn eq(&self, other: &Self) -> bool {
        self.blocks.len() == other.blocks.len()
            && self.blocks.iter().zip(&other.blocks).all(|(a, b)| Arc::ptr_eq(a, b))
    }
}

impl GuideBlocks {
    /// Copies `positions`: guide after guide, `vertex_count` vertices each.
    pub fn new(positions: &[Vec3], vertex_count: usize) -> Self {
        let guides = || positions.chunks_exact(vertex_count);
        let (lo, hi) = guides().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), guide| {
            (lo.min(guide[0]), hi.max(guide[0]))
        });
        let scale = 1023.0 / (hi - lo).max_element().max(1e-9);
        let mut at: Vec<u32> = (0..guides().len() as u32).collect();
        at.sort_by_cached_key(|&i| {
            let root = positions[i as usize * vertex_count];
            (morton(((root - lo) * scale).as_uvec3()), i)
        });
        let mut slots = vec![0; at.len()];
        (0u32..).zip(&at).for_each(|(slot, guide)| slots[*guide as usize] = slot);
        let block = |guides: &[u32]| -> Arc<[Vec3]> {
            let vertices = |i: &u32| positions[*i as usize * vertex_count..][..vertex_count].iter().copied();
            guides.iter().flat_map(vertices).collect()
        };
        let blocks = at.chunks(BLOCK).map(block).collect();
        Self { vertex_count, order: Arc::new((slots, at)), blocks }
    }

    /// Returns the number of guides.
    pub fn len(&self) -> usize {
        self.order.0.len()
    }

    /// Returns whether there are no guides.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the block of guide `i`, and its first vertex there.
    fn locate(&self, i: usize) -> (usize, usize) {
        let slot = self.order.0[i] as usize;
        (slot / BLOCK, slot % BLOCK * self.vertex_count)
    }

    /// Returns the vertices of guide `i`.
    pub fn guide(&self, i: usize) -> &[Vec3] {
        let (block, first) = self.locate(i);
        &self.blocks[block][first..][..self.vertex_count]
    }

    /// Returns all positions, guide after guide.
    pub fn positions(&self) -> Vec<Vec3> {
        (0..self.len()).flat_map(|i| self.guide(i).iter().copied()).collect()
    }

    /// Returns a copy with other vertices for the guides in `changed`.
    #[must_use]
    pub fn with<'a>(&self, changed: impl IntoIterator<Item = (usize, &'a [Vec3])>) -> Self {
        let mut blocks: BTreeMap<usize, Vec<Vec3>> = BTreeMap::new();
        for (i, vertices) in changed {
            let (block, first) = self.locate(i);
            let block = blocks.entry(block).or_insert_with(|| self.blocks[block].to_vec());
            block[first..][..self.vertex_count].copy_from_slice(vertices);
        }
        let mut copy = self.clone();
        for (i, block) in blocks {
            copy.blocks[i] = block.into();
        }
        copy
    }

    /// Returns the guides in blocks that `other` does not share. Both are versions of the same guides.
    pub fn differing<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = usize> + 'a {
        let pairs = self.blocks.iter().zip(&other.blocks).zip(self.order.1.chunks(BLOCK));
        let differ = pairs.filter(|((a, b), _)| !Arc::ptr_eq(a, b));
        differ.flat_map(|(_, guides)| guides.iter().map(|guide| *guide as usize))
    }

    /// Returns the bytes of the blocks.
    pub fn bytes(&self) -> usize {
        self.blocks.iter().map(|block| size_of_val(&**block)).sum()
    }

    /// Returns the bytes of the blocks that `other` does not share.
    pub fn unshared_bytes(&self, other: &Self) -> usize {
        let pairs = self.blocks.iter().zip(&other.blocks);
        pairs.filter(|(a, b)| !Arc::ptr_eq(a, b)).map(|(block, _)| size_of_val(&**block)).sum()
    }
}
