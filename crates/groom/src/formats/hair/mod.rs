//! `.hair`: Cem Yuksel's binary format.
//!
//! A header of 128 bytes (magic, numbers of strands and points, flags, defaults, 88 bytes of text) precedes the arrays
//! whose flags are set, in the order of the flags.

mod read;
mod write;

pub(super) use read::read;
pub(super) use write::encode;

/// Flags of the arrays in a file.
const SEGMENTS: u32 = 1;
const POINTS: u32 = 2;
const THICKNESS: u32 = 4;
const TRANSPARENCY: u32 = 8;
const COLORS: u32 = 16;
