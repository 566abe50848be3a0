//! How strands are drawn as cards.

use crate::{Error, Result, mesh::paint::Texture};
use glam::Vec2;

/// How strands are drawn as cards.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardSheet {
    /// The parts of the cards between two columns, in the order in which they are blended.
    pub strips: Vec<CardStrip>,
    /// Number of strands that the cards replace.
    pub strands: u32,
    /// Brightness (sRGB) and coverage of the cards.
    pub texture: Texture,
    /// Factor on the texture's color: the inverse of its mean, so that cards are as bright as the hair.
    pub gain: f32,
}

/// The part of a card between two columns. It has as many rows as the strands have vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CardStrip {
    /// Strands along both edges.
    pub columns: [u32; 2],
    /// Texture coordinates of both columns at the root.
    pub roots: [Vec2; 2],
    /// Texture coordinates of both columns at the tip.
    pub tips: [Vec2; 2],
}

impl CardSheet {
    /// Returns the strips for strands in another order: `order` has for each place the index of its strand.
    ///
    /// # Errors
    /// [`Error::Unusable`] for strips between strands that are not in `order`.
    pub fn strips_in(&self, order: &[u32]) -> Result<Vec<CardStrip>> {
        let mut indices = vec![None; order.len()];
        for (index, strand) in (0..).zip(order) {
            if let Some(slot) = indices.get_mut(*strand as usize) {
                *slot = Some(index);
            }
        }
        let mut strips = self.strips.clone();
        for column in strips.iter_mut().flat_map(|strip| &mut strip.columns) {
            let index = indices.get(*column as usize).copied().flatten();
            *column = index.ok_or_else(|| Error::Unusable("the cards belong to another groom".into()))?;
        }
        Ok(strips)
    }
}
