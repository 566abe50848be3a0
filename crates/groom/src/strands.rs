//! Explicit strands: the common form of all groom files and all grown hair.

use crate::attribute::StrandAttribute;
use glam::{Vec2, Vec3};

/// Strands as flat arrays: strand `i` owns the vertices `offsets[i]..offsets[i + 1]`, root first.
///
/// After import: meters, right-handed, Y up, face toward +Z.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Strands {
    /// Offset of each strand's first vertex, and the number of vertices: starts with 0, never decreases.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub offsets: Vec<u32>,
    /// Vertex positions, meters.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub positions: Vec<Vec3>,
    /// Vertex radii, meters, or empty if the source has none.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub radii: Vec<f32>,
    /// Vertex colors, linear sRGB, or empty.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub colors: Vec<Vec3>,
    /// Scalp texture coordinates, one per strand, or empty.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub root_uvs: Vec<Vec2>,
    /// Whether the tip is fixed to the head like the root, one per strand; or empty for none.
    pub tip_pinned: Vec<bool>,
    /// Guide data from the file, one per strand, or empty.
    pub marks: Vec<Mark>,
    /// Custom attributes.
    pub attributes: Vec<StrandAttribute>,
}

/// Data of a strand in a file that describe guides and groups.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Mark {
    /// Whether the strand is a guide, which others follow.
    pub guide: bool,
    /// Number by which other strands refer to it.
    pub id: i32,
    /// Number of the strand's group.
    pub group: i32,
    /// Numbers of the guides that the strand follows.
    pub closest: [i32; 3],
    /// Weight of each guide; all 0 if the file has none.
    pub weights: [f32; 3],
}

/// Child strands of one strand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Followers {
    /// Number of child strands.
    pub count: u32,
    /// Maximum distance of the roots from the strand, meters; `None` if the file has none, for half the distance of the
    /// strand's neighbors.
    pub radius: Option<f32>,
}

impl Strands {
    /// Returns the number of strands.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Returns whether there are no strands.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the vertex range of strand `i`.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }

    /// Returns the vertices of strand `i`, root first.
    pub fn strand(&self, i: usize) -> &[Vec3] {
        &self.positions[self.range(i)]
    }

    /// Iterates over the strands in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[Vec3]> {
        self.offsets.windows(2).map(|w| &self.positions[w[0] as usize..w[1] as usize])
    }

    /// Returns the length of strand `i` along its segments, meters.
    pub fn length(&self, i: usize) -> f32 {
        self.strand(i).windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    /// Returns whether any strand is marked as a guide.
    pub fn has_guides(&self) -> bool {
        self.marks.iter().any(|mark| mark.guide)
    }

    /// Adds a strand without attributes.
    pub fn push(&mut self, vertices: &[Vec3]) {
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        self.positions.extend_from_slice(vertices);
        self.offsets.push(self.positions.len() as u32);
    }

    /// Returns the strands `indices` with all their attributes.
    #[must_use]
    pub fn subset(&self, indices: impl IntoIterator<Item = usize>) -> Self {
        let mut some = self.emptied();
        for i in indices {
            self.range(i).for_each(|vertex| some.push_between(self, [vertex, vertex], 0.0));
            some.end_like(self, i);
        }
        some
    }

    /// Returns the attributes without strands.
    pub(crate) fn emptied(&self) -> Self {
        let attributes = self.attributes.iter().map(StrandAttribute::emptied).collect();
        Self { offsets: vec![0], attributes, ..Self::default() }
    }

    /// Appends the vertex at the fraction `t` between the vertices `a` and `b` of `from`.
    pub(crate) fn push_between(&mut self, from: &Self, [a, b]: [usize; 2], t: f32) {
        self.positions.push(from.positions[a].lerp(from.positions[b], t));
        if let (Some(ra), Some(rb)) = (from.radii.get(a), from.radii.get(b)) {
            self.radii.push(ra + (rb - ra) * t);
        }
        if let (Some(ca), Some(cb)) = (from.colors.get(a), from.colors.get(b)) {
            self.colors.push(ca.lerp(*cb, t));
        }
        self.push_custom(from, [a, b], t);
    }

    /// Appends the custom attributes of such a vertex.
    pub(crate) fn push_custom(&mut self, from: &Self, ends: [usize; 2], t: f32) {
        let both = self.attributes.iter_mut().zip(&from.attributes).filter(|(_, from)| from.per_vertex);
        both.for_each(|(attribute, from)| attribute.push_between(from, ends, t));
    }

    /// Ends a strand at the last vertex, with the attributes of strand `i` of `from`.
    pub(crate) fn end_like(&mut self, from: &Self, i: usize) {
        self.offsets.push(self.positions.len() as u32);
        self.root_uvs.extend(from.root_uvs.get(i));
        self.tip_pinned.extend(from.tip_pinned.get(i));
        self.marks.extend(from.marks.get(i));
        let both = self.attributes.iter_mut().zip(&from.attributes).filter(|(_, from)| !from.per_vertex);
        both.for_each(|(attribute, from)| attribute.numbers.extend(from.values(i..i + 1)));
    }

    /// Returns the minimum and maximum corner over all vertices, or `None` without vertices.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_follow_strands() {
        let mut strands = Strands::default();
        strands.push(&[Vec3::ZERO, Vec3::Y]);
        strands.push(&[Vec3::X, Vec3::X, Vec3::X * 2.0]);
        strands.push(&[Vec3::Z, Vec3::Z * 2.0]);
        strands.root_uvs = (0..3).map(|i| Vec2::splat(i as f32)).collect();
        let row = |name: &str, per_vertex, numbers: &[f32]| StrandAttribute {
            name: name.into(),
            per_vertex,
            is_integer: true,
            width: 1,
            numbers: numbers.into(),
        };
        strands.attributes =
            vec![row("id", false, &[7.0, 8.0, 9.0]), row("k", true, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0])];
        let some = strands.subset([2, 1]);
        assert_eq!((some.len(), some.strand(0)), (2, strands.strand(2)));
        assert_eq!(some.root_uvs, [Vec2::splat(2.0), Vec2::splat(1.0)]);
        assert_eq!(some.attributes[0].numbers, [9.0, 8.0]);
        assert_eq!(some.attributes[1].numbers, [5.0, 6.0, 2.0, 3.0, 4.0]);
        let mut repaired = strands;
        crate::lint::repair(&mut repaired);
        assert_eq!(repaired.attributes[1].numbers, [0.0, 1.0, 2.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn pushed_strands_are_stored_in_order() {
        let mut strands = Strands::default();
        assert!(strands.is_empty() && strands.bounds().is_none());
        strands.push(&[Vec3::ZERO, Vec3::Y, Vec3::Y * 3.0]);
        strands.push(&[Vec3::X, Vec3::X * 2.0]);
        assert_eq!(strands.len(), 2);
        assert_eq!(strands.strand(1), &[Vec3::X, Vec3::X * 2.0]);
        assert_eq!(strands.length(0), 3.0);
        assert_eq!(strands.bounds(), Some((Vec3::ZERO, Vec3::new(2.0, 3.0, 0.0))));
    }
}
