//! `.abc`: Alembic, the exchange format of film studios and Unreal, in its current container (Ogawa).

mod read;
mod write;

pub(super) use read::{read, read_mesh};
pub(super) use write::{cache, encode};

use std::path::Path;

/// Returns whether a file has curves. Schema names are stored as plain text.
pub(super) fn is_groom(_: &Path, bytes: &[u8]) -> bool {
    bytes.windows(14).any(|window| window == b"AbcGeom_Curve_")
}
