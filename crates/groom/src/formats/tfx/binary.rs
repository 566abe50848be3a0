//! `.tfx` versions 3 and 4: little-endian binary, with the same number of vertices in every strand.
//!
//! Both begin with the version (f32), the number of strands, and the vertices per strand. Version 3 continues with the
//! child strands per guide (without a radius), a flag that pins every tip and, from byte 144, the offsets of positions
//! (3 × f32), thickness, strand texture coordinates and colors. Version 4 has, from byte 12, the offsets of positions
//! (4 × f32, w = 0 for a pinned vertex), strand texture coordinates, vertex texture coordinates, thickness and colors.
//! An offset of 0 means that the array is absent.

use glam::{Vec2, Vec3, Vec4};

use crate::{
    error::{At, Result},
    formats::{
        raw::{Raw, declared},
        source::Source,
    },
};

/// Reads the whole file.
pub(super) fn read(source: &Source) -> Result<Raw> {
    let version = source.f32("header", 0)?;
    let four = match version.to_bits() {
        _ if (3.0..4.0).contains(&version) => false,
        _ if (4.0..5.0).contains(&version) => true,
        _ => {
            return Err(source.problem(
                At::Byte(0),
                "the file is not a .tfx file: it starts with neither “version” nor the number 3 or 4",
            ));
        }
    };
    let header = if four { 160 } else { 296 };
    source.array("header bytes", 0, header, 1)?;
    let field = |at| source.u32("header", at);
    let (strands, per_strand) = (u64::from(field(4)?), u64::from(field(8)?));
    if strands == 0 {
        return Err(source.problem(At::Byte(4), "the file says it has 0 strands"));
    }
    if per_strand == 0 {
        return Err(source.problem(At::Byte(8), "the strands have 0 vertices"));
    }
    // The product of two `u32` fits in a `u64`.
    let vertices = strands * per_strand;
    source.check_vertices(4, vertices)?;
    let offset = |at: u64| -> Result<Option<u64>> {
        match u64::from(field(at)?) {
            0 => Ok(None),
            o if o < header => {
                Err(source.problem(At::Byte(at), format!("the offset {o} points into the header")))
            }
            o => Ok(Some(o)),
        }
    };
    let (positions_at, thickness_at, uvs_at, colors_at) =
        if four { (12, 24, 16, 28) } else { (144, 148, 152, 156) };
    let Some(positions) = offset(positions_at)? else {
        return Err(source.problem(At::Byte(positions_at), "the file says it has no positions"));
    };
    let what = format!("positions ({strands} strands of {per_strand} vertices)");
    let mut raw = Raw::new(if four { "tfx 4, binary" } else { "tfx 3, binary" });
    if four {
        source.array(&what, positions, vertices, 16)?;
        let all = source.floats::<4>(&what, positions, vertices)?;
        raw.strands.positions = all.iter().map(|p| Vec4::from(*p).truncate()).collect();
        let pinned = |strand: &[[f32; 4]]| strand.len() > 1 && strand.last().is_some_and(|p| p[3] == 0.0);
        let pins: Vec<bool> = all.chunks_exact(per_strand as usize).map(pinned).collect();
        if pins.iter().any(|p| *p) {
            raw.strands.tip_pinned = pins;
        }
    } else {
        raw.strands.positions = source.vec3s(&what, positions, vertices)?;
        if field(16)? != 0 {
            raw.strands.tip_pinned = vec![true; strands as usize];
        }
    }
    raw.strands.offsets = (0..=strands).map(|i| (i * per_strand) as u32).collect();
    if !four {
        raw.follow(u64::from(field(12)?), None);
    }
    if let Some(at) = offset(uvs_at)? {
        let uvs = source.vec2s("strand texture coordinates", at, strands)?;
        if uvs.iter().any(|uv| *uv != Vec2::ZERO) {
            raw.strands.root_uvs = uvs;
        }
    }
    if let Some(at) = offset(colors_at)? {
        let colors = source.floats::<4>("vertex colors", at, vertices)?;
        raw.strands.colors = colors.into_iter().map(|c| Vec3::new(c[0], c[1], c[2])).collect();
    }
    raw.declared = declared(&String::from_utf8_lossy(&source.bytes[32..160]));
    if offset(thickness_at)?.is_some() {
        raw.notes.push("thickness coefficients are ignored: they have no unit".into());
    }
    Ok(raw)
}
