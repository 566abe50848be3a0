//! `.ply`: line sets, as point clouds and reconstructions of hair use them. The element `vertex` has `x`, `y`, `z` and
//! optionally `radius`, the element `edge` has `vertex1` and `vertex2`. A file is text, or binary in either byte order.
//!
//! HAAR, NeuralHaircut and GaussianHaircut write points without edges, strand after strand; [`runs`] finds the strands.

mod read;
mod runs;
mod write;

pub(super) use read::read;
pub(super) use write::encode;
