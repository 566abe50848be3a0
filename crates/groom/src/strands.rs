//! Explicit strands: the common form of every groom file and of all grown hair.

use glam::{Vec2, Vec3};

/// Strands as flat arrays: strand `i` owns the vertices `offsets[i]..offsets[i + 1]`, root first.
///
/// Metres, right-handed, Y up, the face towards +Z, once an importer has done its work.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Strands {
    /// One more than there are strands; starts with 0, never falls.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub offsets: Vec<u32>,
    /// One per vertex, metres.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub positions: Vec<Vec3>,
    /// One per vertex, metres, or empty where the source has none.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub radii: Vec<f32>,
    /// Linear sRGB, one per vertex, or empty.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub colors: Vec<Vec3>,
    /// Scalp texture coordinates, one per strand, or empty.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub root_uvs: Vec<Vec2>,
    /// One per strand: whether the tip is fixed to the head as the root is; or empty for none.
    pub tip_pinned: Vec<bool>,
    /// What a file says of each strand besides, one per strand, or empty.
    pub marks: Vec<Mark>,
}

/// What a file says of a strand besides its shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Mark {
    /// Whether it is a guide, which others follow.
    pub guide: bool,
    /// Its number, by which others name it.
    pub id: i32,
    /// The number of its group.
    pub group: i32,
    /// The numbers of the guides that it follows.
    pub closest: [i32; 3],
    /// How far it follows each; all 0 where the file does not say.
    pub weights: [f32; 3],
}

/// The followers of one strand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Followers {
    /// How many.
    pub count: u32,
    /// How far from the strand at most, metres; `None` where the file does not say: half as far as its
    /// neighbours are.
    pub radius: Option<f32>,
}

impl Strands {
    /// The number of strands.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no strand.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertex range of strand `i`.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }

    /// The vertices of strand `i`, root first.
    pub fn strand(&self, i: usize) -> &[Vec3] {
        &self.positions[self.range(i)]
    }

    /// The strands in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[Vec3]> {
        self.offsets.windows(2).map(|w| &self.positions[w[0] as usize..w[1] as usize])
    }

    /// The length of strand `i` along its segments, metres.
    pub fn length(&self, i: usize) -> f32 {
        self.strand(i).windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    /// Whether some strands are marked as guides.
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

    /// The smallest and largest corner over all vertices, or `None` without vertices.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pushed_strands_come_back() {
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
