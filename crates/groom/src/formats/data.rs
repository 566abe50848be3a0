//! `.data`: strands of USC-HairSalon and later reconstructions, little-endian. A file stores the number of strands
//! (i32), then for each strand its number of points (i32) and the points (3 × f32). It states neither unit nor axes.

use super::{
    raw::Raw,
    source::Source,
    writer::{EncodedFile, put},
};
use crate::{
    Strands,
    error::{At, Error, Result},
    orient::LengthUnit,
};

/// Reads the whole file.
pub(super) fn read(source: &Source) -> Result<Raw> {
    let mut raw = Raw::new("data strands");
    let count = |what: &str, at: u64| -> Result<u64> {
        let count = source.u32(what, at)? as i32;
        u64::try_from(count)
            .map_err(|_| source.problem(At::Byte(at), format!("the {what} is negative: {count}")))
    };
    let strands = count("number of strands", 0)?;
    if strands == 0 {
        return Err(source.problem(At::Byte(0), "the file says it has 0 strands"));
    }
    // Each strand stores at least its number of points. This check bounds the number of strands by the file's size.
    source.array("numbers of points", 4, strands, 4)?;
    let out = &mut raw.strands;
    out.offsets.push(0);
    let (mut at, mut empty) = (4, 0u64);
    for i in 0..strands {
        let points = count("number of points", at)?;
        source.check_vertices(at, out.positions.len() as u64 + points)?;
        out.positions.extend(source.vec3s(&format!("points of strand {i}"), at + 4, points)?);
        at += 4 + 12 * points;
        match points {
            0 => empty += 1,
            _ => out.offsets.push(out.positions.len() as u32),
        }
    }
    if empty > 0 {
        raw.notes.push(format!("{empty} strands without points are skipped"));
    }
    let more = source.bytes.len() as u64 - at;
    if more > 0 {
        raw.notes.push(format!("{more} bytes after the last strand are ignored"));
    }
    Ok(raw)
}

/// Encodes strands.
pub(super) fn encode(strands: &Strands, _: Option<LengthUnit>) -> Result<EncodedFile> {
    let count = |n: usize| {
        let many = || Error::Unusable(format!("a .data file cannot store a count of {n}"));
        i32::try_from(n).map_err(|_| many())
    };
    let mut bytes = count(strands.len())?.to_le_bytes().to_vec();
    for strand in strands.iter() {
        bytes.extend_from_slice(&count(strand.len())?.to_le_bytes());
        strand.iter().for_each(|p| put(&mut bytes, p.to_array()));
    }
    Ok(bytes.into())
}
