//! `.tfx`: AMD's TressFX, version 2 as text, versions 3 and 4 as binary.

mod binary;
mod text;
mod write;

pub(super) use write::encode;

use super::{raw::Raw, source::Source};
use crate::Result;

/// Reads any version.
pub(super) fn read(source: &Source) -> Result<Raw> {
    // Text begins with a name or a comment, binary with the version as a float. The bytes of a float may be letters.
    let version = source.bytes.first_chunk().map(|bytes| f32::from_le_bytes(*bytes));
    let first = source.bytes.iter().find(|b| !b.is_ascii_whitespace());
    let is_text = first.is_some_and(|b| b.is_ascii_alphabetic() || *b == b'#');
    let is_binary = version.is_some_and(|version| (3.0..5.0).contains(&version));
    if is_text && !is_binary { text::read(source) } else { binary::read(source) }
}
