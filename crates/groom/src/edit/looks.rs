//! Painted values of a version.

use crate::bound::Strand;

/// Painted values of a version.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StrandLooks {
    /// Width and colors of each strand.
    pub strands: Vec<Strand>,
    /// Stiffness of each guide.
    pub stiffness: Vec<f32>,
    /// Whether each guide is held.
    pub held: Vec<bool>,
}

impl StrandLooks {
    /// Returns the size, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.strands) + size_of_val(&*self.stiffness) + self.held.len()
    }

    /// Returns all numbers, as bits.
    pub fn bits(&self) -> impl Iterator<Item = u32> {
        let strands = self.strands.iter().flat_map(|it| [it.radius.to_bits(), it.root_color, it.tip_color]);
        let guides = self.stiffness.iter().map(|it| it.to_bits());
        strands.chain(guides).chain(self.held.iter().map(|it| u32::from(*it)))
    }
}
