//! Versions of an edited groom.

use super::{carry, guide_blocks::GuideBlocks};
use crate::{Error, Groom, Result, orient::Choice};
use glam::Vec3;
use std::{path::PathBuf, sync::Arc};

/// The head under an edited groom, as its file stores it.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum HeadFiles {
    /// No head.
    #[default]
    None,
    /// The built-in head.
    BuiltIn,
    /// Files, as they came.
    Files {
        /// Names and contents.
        files: Vec<(PathBuf, Arc<[u8]>)>,
        /// Unit and axes of the head.
        orientation: Choice,
    },
}

/// What all versions of a groom share.
#[derive(Debug)]
pub(super) struct Base {
    /// The groom before the first stroke.
    pub groom: Groom,
    pub head: HeadFiles,
    /// Plane between left and right: x, meters.
    pub middle: f32,
    /// The guides before the first stroke.
    pub guides: GuideBlocks,
}

/// A version of a groom. Clones and other versions share what does not differ.
#[derive(Clone, Debug)]
pub struct GroomDocument {
    base: Arc<Base>,
    guides: GuideBlocks,
}

impl PartialEq for GroomDocument {
    /// Whether both are the same version.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.base, &other.base) && self.guides == other.guides
    }
}

impl GroomDocument {
    /// Creates the first version: `groom` on `head`. `middle` is the plane between left and right (x, meters).
    ///
    /// # Errors
    /// [`Error::Unusable`] for a groom without guides or strands, and for one that its bindings do not fit.
    pub fn new(groom: Groom, head: HeadFiles, middle: f32) -> Result<Self> {
        check(&groom)?;
        let guides = GuideBlocks::new(&groom.guides.positions, groom.guides.vertex_count as usize);
        let base = Base { groom, head, middle, guides: guides.clone() };
        Ok(Self { base: Arc::new(base), guides })
    }

    /// Returns this version with other vertices for the guides in `changed`.
    #[must_use]
    pub fn with<'a>(&self, changed: impl IntoIterator<Item = (usize, &'a [Vec3])>) -> Self {
        Self { base: self.base.clone(), guides: self.guides.with(changed) }
    }

    /// Returns the version before the first stroke.
    #[must_use]
    pub fn original(&self) -> Self {
        Self { base: self.base.clone(), guides: self.base.guides.clone() }
    }

    /// Returns the groom before the first stroke.
    pub fn base(&self) -> &Groom {
        &self.base.groom
    }

    /// Returns the head.
    pub fn head(&self) -> &HeadFiles {
        &self.base.head
    }

    /// Returns the plane between left and right: x, meters.
    pub fn middle(&self) -> f32 {
        self.base.middle
    }

    /// Returns the guides.
    pub fn guides(&self) -> &GuideBlocks {
        &self.guides
    }

    /// Returns the vertices of guide `i`.
    pub fn guide(&self, i: usize) -> &[Vec3] {
        self.guides.guide(i)
    }

    /// Returns the number of vertices per guide.
    pub fn vertex_count(&self) -> usize {
        self.base.groom.guides.vertex_count as usize
    }

    /// Whether `other` is a version of the same groom.
    pub fn is_version_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.base, &other.base)
    }

    /// Returns the groom: the guides, and the strands that they carry.
    pub fn groom(&self) -> Groom {
        carry::groom(&self.base.groom, &self.guides, &self.base.guides)
    }

    /// Returns a hash of the guides (FNV-1a of their bits): equal for equal positions.
    pub fn hash(&self) -> u64 {
        let bytes = (0..self.guides.len()).flat_map(|i| self.guide(i)).flat_map(|p| p.to_array());
        bytes
            .flat_map(|x| x.to_bits().to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    /// Returns the bytes that this version needs besides `other`.
    pub fn bytes_beside(&self, other: &Self) -> usize {
        self.guides.bytes_beside(&other.guides)
    }
}

/// Checks that counts and indices of `groom` match and that its guides are finite.
fn check(groom: &Groom) -> Result<()> {
    let (guides, strands) = (&groom.guides, &groom.strands);
    let (n, count) = (guides.vertex_count as usize, guides.len());
    let wrong = |problem: &str| Err(Error::Unusable(format!("the groom cannot be edited: {problem}")));
    if count == 0 || strands.is_empty() {
        return wrong("it has no strands");
    }
    let fits = (2..=crate::MAX_GUIDE_VERTICES as usize).contains(&n)
        && (2..=crate::MAX_STRAND_VERTICES).contains(&strands.vertex_count)
        && guides.positions.len() == n * count
        && guides.strands.len() == count
        && guides.tip_pinned.len() == count
        && strands.bindings.len() == strands.len()
        && strands.rest.len() == strands.len() * strands.vertex_count as usize;
    if !fits {
        return wrong("the numbers of its vertices do not match");
    }
    if !guides.positions.iter().all(|p| p.is_finite() && p.abs().max_element() < 1e3) {
        return wrong("a guide is not within a kilometer");
    }
    if strands.bindings.iter().any(|binding| binding.guides.iter().any(|guide| *guide as usize >= count)) {
        return wrong("a strand follows a guide that is missing");
    }
    Ok(())
}
