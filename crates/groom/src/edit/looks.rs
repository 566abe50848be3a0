//! Painted values of a version.

use crate::bound::Strand;

/// Painted values of a version.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StrandLooks {
    /// Width and colors of each strand.
    pub strands: Vec<Strand>,
    /// Stiffness of each guide.
    pub stiffness: Vec<f32>,
}

impl StrandLooks {
    /// Returns the size, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.strands) + size_of_val(&*self.stiffness)
    }

    /// Returns all numbers, as bits.
    pub fn bits(&self) -> impl Iterator<Item = u32> {
        let strands = self.strands.iter().flat_map(|it| [it.radius.to_bits(), it.root_color, it.tip_color]);
        strands.chain(self.stiffness.iter().map(|it| it.to_bits()))
    }
}
