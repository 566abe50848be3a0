//! Painted values of a version.

use crate::{bound::Strand, restyle::painted::StrandShape};

/// Painted values of a version.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PaintedValues {
    /// Width and colors of each strand.
    pub strands: Vec<Strand>,
    /// Clumps, curls and frizz of each strand; empty for none.
    pub shapes: Vec<StrandShape>,
    /// Stiffness of each guide.
    pub stiffness: Vec<f32>,
    /// Whether each guide is held.
    pub held: Vec<bool>,
}

impl PaintedValues {
    /// Returns the size, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.strands)
            + size_of_val(&*self.shapes)
            + size_of_val(&*self.stiffness)
            + self.held.len()
    }

    /// Returns all numbers, as bits.
    pub fn bits(&self) -> impl Iterator<Item = u32> {
        let strands = self.strands.iter().flat_map(|it| [it.radius.to_bits(), it.root_color, it.tip_color]);
        let guides = self.stiffness.iter().map(|it| it.to_bits());
        let shapes = self.shapes.iter().map(|shape| u32::from_le_bytes(bytemuck::cast(*shape)));
        strands.chain(shapes).chain(guides).chain(self.held.iter().map(|it| u32::from(*it)))
    }
}
