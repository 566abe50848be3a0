//! `.obj`: Wavefront OBJ, with line elements as strands or faces as a mesh.

mod lines;
mod mesh;
mod write;

pub(super) use lines::read;
pub(super) use mesh::read as read_mesh;
pub(super) use write::{encode, encode_mesh};

use std::path::Path;

/// Returns whether the first element is a line. Also `true` for a file without elements, for which the strand reader
/// returns an error.
pub(super) fn is_groom(_: &Path, bytes: &[u8]) -> bool {
    let mut elements = bytes.split(|b| *b == b'\n').filter_map(|line| {
        let line = line.trim_ascii_start();
        let next = line.get(1).is_some_and(u8::is_ascii_whitespace);
        line.first().copied().filter(|first| next && matches!(first, b'l' | b'f'))
    });
    elements.next() != Some(b'f')
}
