//! `.ply`: sets of lines, as point clouds and reconstructions of hair come in: an element `vertex` with `x`, `y`, `z` and
//! perhaps `radius`, and an element `edge` with `vertex1` and `vertex2`. As text or binary, of either byte order.

mod read;
mod write;

pub(super) use read::read;
pub(super) use write::encode;
