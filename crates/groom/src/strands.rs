//! Explicit strands: the common form of all groom files and all grown hair.

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
