//! Writes `.tfx` version 4.

use crate::{
    Strands,
    error::{Error, Result},
    formats::{
        raw::MARK,
        writer::{EncodedFile, put},
    },
    orient::LengthUnit,
};

const HEADER: usize = 160;

/// Encodes strands as version 4.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
    let per_strand = strands.iter().map(<[_]>::len).max().unwrap_or(0);
    let vertices = strands.len() as u64 * per_strand as u64;
    let with_uvs = !strands.root_uvs.is_empty();
    let uvs_at = HEADER as u64 + 16 * vertices;
    let colors_at = uvs_at + if with_uvs { 8 * strands.len() as u64 } else { 0 };
    let end = colors_at + if strands.colors.is_empty() { 0 } else { 16 * vertices };
    if end > u64::from(u32::MAX) {
        return Err(Error::Unusable(format!(
            "the file would have {end} bytes, more than the 4 GiB that a .tfx file can address"
        )));
    }
    let mut bytes = Vec::with_capacity(end as usize);
    put(&mut bytes, [4.0]);
    let uvs = if with_uvs { uvs_at } else { 0 };
    let colors = if strands.colors.is_empty() { 0 } else { colors_at };
    let header = [strands.len() as u64, per_strand as u64, HEADER as u64, uvs, 0, 0, colors];
    header.iter().for_each(|v| bytes.extend_from_slice(&(*v as u32).to_le_bytes()));
    bytes.extend_from_slice(unit.map_or("", |_| MARK).as_bytes());
    bytes.resize(HEADER, 0);
    // The format has one number of vertices for all strands; shorter strands repeat their tip.
    let indices = |i: usize| {
        let range = strands.range(i);
        let last = range.end.saturating_sub(1);
        (0..per_strand).map(move |k| (range.start + k).min(last))
    };
    for i in 0..strands.len() {
        let pinned = strands.tip_pinned.get(i).copied().unwrap_or(false);
        let range = strands.range(i);
        for v in indices(i) {
            let fixed = v == range.start || (pinned && v + 1 == range.end);
            let p = strands.positions[v];
            put(&mut bytes, [p.x, p.y, p.z, if fixed { 0.0 } else { 1.0 }]);
        }
    }
    strands.root_uvs.iter().for_each(|uv| put(&mut bytes, uv.to_array()));
    if !strands.colors.is_empty() {
        for v in (0..strands.len()).flat_map(indices) {
            let c = strands.colors[v];
            put(&mut bytes, [c.x, c.y, c.z, 1.0]);
        }
    }
    let mut notes = Vec::new();
    if strands.iter().any(|s| s.len() < per_strand) {
        notes.push(format!(
            "shorter strands repeat their tip up to {per_strand} vertices, because the format stores one vertex count for all strands (reading merges them again)"
        ));
    }
    Ok(EncodedFile { bytes, notes })
}
