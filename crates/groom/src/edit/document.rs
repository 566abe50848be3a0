//! Versions of an edited groom.

use super::{
    cuts::{Cuts, LengthChanges},
    deform::DeformedStrands,
    guide_blocks::GuideBlocks,
    painted_values::PaintedValues,
};
use crate::{Error, Groom, Result, orient::OrientationOverride, restyle::painted};
use glam::Vec3;
use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError, Weak},
};

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
        orientation: OrientationOverride,
    },
}

/// Data that all versions of a groom share.
#[derive(Debug)]
pub(super) struct Family {
    head: HeadFiles,
    /// Plane between left and right: x, meters.
    mirror_x: f32,
}

/// Data that versions with the same lengths share.
#[derive(Debug)]
pub(super) struct Base {
    family: Arc<Family>,
    /// The groom before the first stroke, with its lengths.
    source: Arc<Groom>,
    /// Index of each strand before any stroke; `None` if they are the same strands.
    origins: Option<Arc<[u32]>>,
    cuts: Option<Cuts>,
    /// The groom before the first stroke, cut; kept while an editor or a caller holds it.
    groom: Mutex<Weak<Groom>>,
    /// Its guides.
    guides: GuideBlocks,
}

impl Base {
    pub fn new(family: Arc<Family>, source: Arc<Groom>, cuts: Option<Cuts>) -> Self {
        let groom = cuts.as_ref().map_or_else(|| source.clone(), |cuts| Arc::new(cuts.apply(&source)));
        let guides = GuideBlocks::new(&groom.guides.positions, groom.guides.vertex_count as usize);
        Self { family, source, origins: None, cuts, groom: Mutex::new(Arc::downgrade(&groom)), guides }
    }

    /// Returns the base with these origins of its strands.
    pub fn with_origins(self, origins: Option<Arc<[u32]>>) -> Self {
        Self { origins, ..self }
    }

    /// Returns the size of the groom, bytes.
    fn bytes(&self) -> usize {
        let Groom { guides, strands } = &*self.source;
        let strands =
            size_of_val(&*strands.rest) + size_of_val(&*strands.bindings) + size_of_val(&*strands.strands);
        size_of_val(&*guides.positions) + strands
    }

    fn groom(&self) -> Arc<Groom> {
        let Some(cuts) = &self.cuts else { return self.source.clone() };
        let mut kept = self.groom.lock().unwrap_or_else(PoisonError::into_inner);
        kept.upgrade().unwrap_or_else(|| {
            let groom = Arc::new(cuts.apply(&self.source));
            *kept = Arc::downgrade(&groom);
            groom
        })
    }
}

/// A version of a groom. Clones and other versions share what does not differ.
#[derive(Clone, Debug)]
pub struct GroomDocument {
    base: Arc<Base>,
    guides: GuideBlocks,
    /// Painted values; `None` for the values of the base.
    painted_values: Option<Arc<PaintedValues>>,
}

impl PartialEq for GroomDocument {
    /// Whether both are the same version.
    fn eq(&self, other: &Self) -> bool {
        self.is_pose_of(other) && self.guides == other.guides
    }
}

impl GroomDocument {
    /// Creates the first version: `groom` on `head`. `mirror_x` is the plane between left and right (x, meters).
    ///
    /// # Errors
    /// [`Error::Unusable`] for a groom without guides or strands, and for one that its bindings do not fit.
    pub fn new(groom: Groom, head: HeadFiles, mirror_x: f32) -> Result<Self> {
        check(&groom)?;
        Ok(Self::at_base(Base::new(Arc::new(Family { head, mirror_x }), Arc::new(groom), None)))
    }

    /// Returns this version with other vertices for the guides in `changed`.
    #[must_use]
    pub fn with<'a>(&self, changed: impl IntoIterator<Item = (usize, &'a [Vec3])>) -> Self {
        Self { guides: self.guides.with(changed), ..self.clone() }
    }

    /// Returns this version with other lengths. `lengths` are factors on the current lengths.
    #[must_use]
    pub(super) fn with_lengths(&self, lengths: &LengthChanges) -> Self {
        let Base { family, source, cuts, .. } = &*self.base;
        let before = cuts.clone().unwrap_or_else(|| Cuts::none(source));
        let after = before.changed(source, lengths);
        let base =
            Base::new(family.clone(), source.clone(), Some(after)).with_origins(self.base.origins.clone());
        let after = base.cuts.as_ref().unwrap_or(&before);
        let changed_guides: Vec<(usize, Vec<Vec3>)> = (0..self.guides.len())
            .filter_map(|i| Some((i, before.guide_to(after, i, self.guide(i))?)))
            .collect();
        let guides = self.guides.with(changed_guides.iter().map(|(i, guide)| (*i, &guide[..])));
        Self { base: Arc::new(base), guides, painted_values: self.painted_values.clone() }
    }

    pub(super) fn family(&self) -> Arc<Family> {
        self.base.family.clone()
    }

    /// Returns the version of `base` before the first stroke.
    pub(super) fn at_base(base: Base) -> Self {
        Self { guides: base.guides.clone(), base: Arc::new(base), painted_values: None }
    }

    /// Returns this version before the first stroke, with its lengths.
    #[must_use]
    pub fn original(&self) -> Self {
        Self { guides: self.base.guides.clone(), ..self.clone() }
    }

    /// Returns the groom before the first stroke, with the lengths of this version.
    pub fn base(&self) -> Arc<Groom> {
        self.base.groom()
    }

    /// Returns the index of each strand before any stroke. New strands have indices of their own, which follow these.
    pub fn origins(&self) -> Vec<u32> {
        let same = || (0..self.base.source.strands.len() as u32).collect();
        self.base.origins.as_deref().map_or_else(same, <[u32]>::to_vec)
    }

    /// Returns the head.
    pub fn head(&self) -> &HeadFiles {
        &self.base.family.head
    }

    /// Returns the plane between left and right: x, meters.
    pub fn mirror_x(&self) -> f32 {
        self.base.family.mirror_x
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
        self.base.source.guides.vertex_count as usize
    }

    /// Whether `other` is a version of the same groom.
    pub fn is_version_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.base.family, &other.base.family)
    }

    /// Whether `other` is a version of the same groom with the same guides, lengths and painted values, so that only
    /// shapes differ.
    pub fn is_pose_of(&self, other: &Self) -> bool {
        let has_same_painted_values = match (&self.painted_values, &other.painted_values) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        Arc::ptr_eq(&self.base, &other.base) && has_same_painted_values
    }

    /// Returns the groom: the guides, and the strands that they carry.
    pub fn groom(&self) -> Groom {
        self.painted_groom(self.deformed_strands())
    }

    /// Returns the groom without painted clumps, curls and frizz.
    pub(super) fn unshaped_groom(&self) -> Groom {
        self.painted_groom(self.unshaped())
    }

    fn painted_groom(&self, strands: DeformedStrands) -> Groom {
        let mut groom = strands.groom(&self.guides);
        if let Some(painted_values) = &self.painted_values {
            groom.strands.strands.clone_from(&painted_values.strands);
            groom.guides.stiffness.clone_from(&painted_values.stiffness);
        }
        groom
    }

    /// Returns the painted values.
    pub(super) fn painted_values(&self) -> PaintedValues {
        let Groom { guides, strands } = &*self.base.source;
        let unpainted = || PaintedValues {
            strands: strands.strands.clone(),
            shapes: Vec::new(),
            stiffness: guides.stiffness.clone(),
            held: vec![false; guides.len()],
        };
        self.painted_values.as_deref().cloned().unwrap_or_else(unpainted)
    }

    /// Returns this version with other painted values.
    pub(super) fn with_painted_values(&self, painted_values: PaintedValues) -> Self {
        Self { painted_values: Some(Arc::new(painted_values)), ..self.clone() }
    }

    /// Returns the strands, carried by the guides.
    pub(super) fn deformed_strands(&self) -> DeformedStrands {
        let shapes = self.shapes();
        match shapes.iter().any(|shape| shape.any()) {
            true => {
                let base = Arc::new(painted::shaped(&self.base.groom(), shapes));
                DeformedStrands::new(base, &self.guides, &self.base.guides)
            }
            false => self.unshaped(),
        }
    }

    /// Returns the strands without painted clumps, curls and frizz, carried by the guides.
    pub(super) fn unshaped(&self) -> DeformedStrands {
        DeformedStrands::new(self.base.groom(), &self.guides, &self.base.guides)
    }

    /// Returns clumps, curls and frizz of each strand; empty for none.
    pub(super) fn shapes(&self) -> &[painted::StrandShape] {
        self.painted_values.as_ref().map_or(&[], |values| &values.shapes)
    }

    /// Returns a hash of guides, lengths and the number of strands (FNV-1a of their bits): equal for equal numbers.
    pub fn hash(&self) -> u64 {
        let bits = (0..self.guides.len()).flat_map(|i| self.guide(i)).flat_map(|p| p.to_array());
        let bits = bits.chain(self.base.cuts.iter().flat_map(Cuts::numbers));
        let count = self.base.source.strands.len() as u64;
        bits.flat_map(|x| x.to_bits().to_le_bytes())
            .chain(self.painted_values.iter().flat_map(|values| values.bits()).flat_map(u32::to_le_bytes))
            .chain(count.to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    /// Returns the bytes that this version needs besides `other`.
    pub fn unshared_bytes(&self, other: &Self) -> usize {
        let is_pose = Arc::ptr_eq(&self.base, &other.base);
        let is_shared = |values: &&Arc<PaintedValues>| {
            other.painted_values.as_ref().is_some_and(|it| Arc::ptr_eq(it, values))
        };
        let painted_bytes = self
            .painted_values
            .as_ref()
            .filter(|values| !is_shared(values))
            .map_or(0, |values| values.bytes());
        let cuts = self.base.cuts.as_ref().filter(|_| !is_pose).map_or(0, Cuts::bytes);
        if self.guides.len() != other.guides.len() {
            return painted_bytes + cuts + self.base.bytes() + self.guides.bytes();
        }
        let source = if Arc::ptr_eq(&self.base.source, &other.base.source) { 0 } else { self.base.bytes() };
        let base = if is_pose { 0 } else { self.base.guides.unshared_bytes(&other.base.guides) };
        self.guides.unshared_bytes(&other.guides) + painted_bytes + cuts + base + source
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
