//! `.glb`, `.gltf`: glTF 2.0, meshes with skins, shapes and animations, and hair as `EXT_tresses_hair`.

mod read;
mod write;

pub(super) use read::{hair::read, read_mesh};
pub(super) use write::{body, character, encode};

use std::path::Path;

/// The extension for hair.
const HAIR: &str = "EXT_tresses_hair";
/// In its `flags`: a strand that others follow.
const GUIDE: u32 = 1;
/// In its `flags`: a strand whose tip is fixed to the body as its root is.
const TIP_PINNED: u32 = 2;
/// The extension for compressed views.
const PACKED: &str = "EXT_meshopt_compression";

/// Whether a file has hair. The names of extensions and lists stand in it as they are.
pub(super) fn is_groom(_: &Path, bytes: &[u8]) -> bool {
    holds(bytes, HAIR)
}

/// Whether a file has hair and a body.
pub(super) fn holds_body(path: &Path, bytes: &[u8]) -> bool {
    is_groom(path, bytes) && holds(bytes, "\"meshes\"")
}

fn holds(bytes: &[u8], word: &str) -> bool {
    bytes.windows(word.len()).any(|window| window == word.as_bytes())
}
