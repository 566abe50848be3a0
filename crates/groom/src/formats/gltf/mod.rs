//! `.glb`, `.gltf`: glTF 2.0 meshes with skins, morph targets and animations, and hair as `EXT_tresses_hair`.

mod read;
mod write;

pub(super) use read::{hair::read, read_mesh};
#[cfg(all(feature = "cards", feature = "textures"))]
pub(crate) use write::{File, INT};
pub(super) use write::{body, character, encode};

use std::path::Path;

/// The hair extension.
const HAIR: &str = "EXT_tresses_hair";
/// Bit of the extension's `flags`: the strand is a guide.
const GUIDE: u32 = 1;
/// Bit of the extension's `flags`: the tip is pinned to the head, as the root is.
const TIP_PINNED: u32 = 2;
/// The extension for compressed buffer views.
const MESHOPT_COMPRESSION: &str = "EXT_meshopt_compression";

/// Returns whether a file has hair. Searches the bytes: `.glb` and `.gltf` both store their JSON as plain text.
pub(super) fn is_groom(_: &Path, bytes: &[u8]) -> bool {
    contains(bytes, HAIR)
}

/// Returns whether a file has hair and the mesh that it grows on.
pub(super) fn holds_body(path: &Path, bytes: &[u8]) -> bool {
    is_groom(path, bytes) && contains(bytes, "\"meshes\"")
}

fn contains(bytes: &[u8], word: &str) -> bool {
    bytes.windows(word.len()).any(|window| window == word.as_bytes())
}
