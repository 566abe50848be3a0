//! Writes `.hair` files.

use super::{COLORS, POINTS, SEGMENTS, THICKNESS};
use crate::{
    Strands,
    error::{Error, Result},
    formats::{
        raw::MARK,
        writer::{EncodedFile, put},
    },
    orient::LengthUnit,
};

/// Encodes strands of 1 to 65536 vertices.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
    let counts: Vec<usize> = strands.iter().map(<[_]>::len).collect();
    if let Some(bad) = counts.iter().position(|n| !(1..=65536).contains(n)) {
        let n = counts[bad];
        return Err(Error::Unusable(format!("strand {bad} has {n} vertices; a .hair file takes 1 to 65536")));
    }
    let uniform = counts.iter().all(|n| *n == counts[0]);
    let flag = |on: bool, flag| if on { flag } else { 0 };
    let flags = POINTS
        | flag(!uniform, SEGMENTS)
        | flag(!strands.radii.is_empty(), THICKNESS)
        | flag(!strands.colors.is_empty(), COLORS);
    let mut bytes = b"HAIR".to_vec();
    let default_segments = if uniform { counts[0] - 1 } else { 0 };
    for v in [strands.len(), strands.positions.len(), flags as usize, default_segments] {
        bytes.extend_from_slice(&(v as u32).to_le_bytes());
    }
    // No default width, opaque, no default color.
    put(&mut bytes, [0.0; 5]);
    bytes.extend_from_slice(unit.map_or("", |_| MARK).as_bytes());
    bytes.resize(128, 0);
    if !uniform {
        bytes.extend(counts.iter().flat_map(|n| ((n - 1) as u16).to_le_bytes()));
    }
    strands.positions.iter().for_each(|p| put(&mut bytes, p.to_array()));
    strands.radii.iter().for_each(|r| put(&mut bytes, [2.0 * r]));
    strands.colors.iter().for_each(|c| put(&mut bytes, c.to_array()));
    Ok(bytes.into())
}
