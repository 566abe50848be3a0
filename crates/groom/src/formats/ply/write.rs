//! Writes binary `.ply` files.

use std::fmt::Write;

use crate::{
    Result, Strands,
    formats::{
        raw::MARK,
        writer::{EncodedFile, put},
    },
    orient::LengthUnit,
};

/// Encodes strands as vertices and edges.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
    let edges = strands.iter().map(|strand| strand.len().saturating_sub(1)).sum::<usize>();
    let mut header = String::from("ply\nformat binary_little_endian 1.0\ncomment Tresses groom\n");
    // Writing into a string cannot fail.
    if unit.is_some() {
        let _ = writeln!(header, "comment {MARK}");
    }
    let _ = writeln!(header, "element vertex {}", strands.positions.len());
    for name in ["x", "y", "z", "radius"].iter().take(if strands.radii.is_empty() { 3 } else { 4 }) {
        let _ = writeln!(header, "property float {name}");
    }
    let _ = writeln!(header, "element edge {edges}\nproperty int vertex1\nproperty int vertex2\nend_header");
    let mut bytes = header.into_bytes();
    for (i, p) in strands.positions.iter().enumerate() {
        put(&mut bytes, p.to_array());
        strands.radii.get(i).into_iter().for_each(|radius| put(&mut bytes, [*radius]));
    }
    for i in 0..strands.len() {
        let range = strands.range(i);
        for v in range.start..range.end.saturating_sub(1) {
            bytes.extend([v as u32, v as u32 + 1].iter().flat_map(|end| end.to_le_bytes()));
        }
    }
    let mut notes = Vec::new();
    if strands.iter().any(|strand| strand.len() < 2) {
        notes.push("strands of one vertex are not written: the format cannot store them".into());
    }
    Ok(EncodedFile { bytes, notes })
}
