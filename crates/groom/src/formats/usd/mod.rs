//! `.usd`, `.usda`, `.usdc`, `.usdz`: USD, the exchange format of Pixar, Blender, Houdini, Unreal and Omniverse.

#[cfg(feature = "usd")]
mod read;
mod write;

#[cfg(feature = "usd")]
pub(super) use read::{holds_body, is_groom, read, read_mesh};
#[cfg(feature = "usd")]
pub(super) use write::packed;
pub(super) use write::{body, cache, character, encode};

/// Documentation string of the files that this crate writes.
const DOC: &str = "Tresses groom";
