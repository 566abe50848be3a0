//! Reads `.hair` files.

use glam::Vec3;

use super::{COLORS, POINTS, SEGMENTS, THICKNESS, TRANSPARENCY};
use crate::{
    error::{At, Result},
    formats::{
        raw::{Raw, declared},
        source::Source,
    },
};

/// Reads the whole file.
pub(crate) fn read(source: &Source) -> Result<Raw> {
    if !source.bytes.starts_with(b"HAIR") {
        return Err(
            source.problem(At::Byte(0), "the file is not a .hair file: it does not start with “HAIR”")
        );
    }
    let header = source.array("header bytes", 0, 128, 1)?;
    let field = |at| source.u32("header", at);
    let (strands, points, flags) = (u64::from(field(4)?), u64::from(field(8)?), field(12)?);
    if strands == 0 {
        return Err(source.problem(At::Byte(4), "the file says it has 0 strands"));
    }
    if flags & POINTS == 0 {
        return Err(source.problem(At::Byte(12), "the flags say that there are no points"));
    }
    source.check_vertices(8, points)?;
    let mut raw = Raw::new("hair");
    let mut at = 128;
    let out = &mut raw.strands;
    if flags & SEGMENTS != 0 {
        let segments = source.array("segment counts", at, strands, 2)?;
        at += 2 * strands;
        let mut sum = 0u64;
        out.offsets.push(0);
        for s in segments.as_chunks().0 {
            sum += u64::from(u16::from_le_bytes(*s)) + 1;
            out.offsets.push(sum as u32);
        }
        if sum != points {
            return Err(source.problem(
                At::Byte(8),
                format!("the file says it has {points} points, but its strands have {sum}"),
            ));
        }
    } else {
        let each = u64::from(field(16)?) + 1;
        if each.checked_mul(strands) != Some(points) {
            let problem = format!(
                "{strands} strands of {each} points do not add up to the {points} points of the header"
            );
            return Err(source.problem(At::Byte(16), problem));
        }
        // The points must fit in the file before their offsets are allocated.
        source.array("points", at, points, 12)?;
        out.offsets = (0..=strands).map(|i| (i * each) as u32).collect();
    }
    out.positions = source.vec3s("points", at, points)?;
    at += 12 * points;
    let default = |at| source.f32("header", at).map(|v| if v.is_finite() { v } else { 0.0 });
    if flags & THICKNESS != 0 {
        let widths = source.floats::<1>("thicknesses", at, points)?;
        at += 4 * points;
        out.radii = widths.into_iter().map(|[w]| 0.5 * w).collect();
    } else if default(20)? > 0.0 {
        out.radii = vec![0.5 * default(20)?; points as usize];
    }
    if flags & TRANSPARENCY != 0 {
        source.array("transparencies", at, points, 4)?;
        at += 4 * points;
        raw.notes.push("transparency per point is ignored".into());
    }
    if flags & COLORS != 0 {
        out.colors = source.vec3s("colors", at, points)?;
    } else {
        let color = Vec3::new(default(28)?, default(32)?, default(36)?);
        // Files without colors store a black default.
        if color != Vec3::ZERO {
            out.colors = vec![color; points as usize];
        }
    }
    raw.declared = declared(&String::from_utf8_lossy(&header[40..]));
    Ok(raw)
}
