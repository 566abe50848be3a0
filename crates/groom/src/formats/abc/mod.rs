//! `.abc`: Alembic, the exchange format of films and of Unreal, in its present container (Ogawa).

mod read;
mod write;

pub(super) use read::{read, read_mesh};
pub(super) use write::{cache, encode};

use std::path::Path;

/// Whether a file has curves: the names of schemas are shared texts, so they stand in it as they are.
pub(super) fn is_groom(_: &Path, bytes: &[u8]) -> bool {
    bytes.windows(14).any(|window| window == b"AbcGeom_Curve_")
}
