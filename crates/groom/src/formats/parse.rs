//! Parses one groom file.

use super::{
    ContentKind, FileFormat, GROOMS,
    raw::{Moment, Raw},
    source::{Files, Source},
};
use crate::error::{At, Result};
use std::path::Path;

/// Parses one groom file at its first frame. `path` decides the format and is named in errors.
pub(crate) fn parse(path: &Path, bytes: &[u8], lenient: bool) -> Result<Raw> {
    parse_at(path, bytes, lenient, Moment::First)
}

/// Parses one groom file at a moment, if the file is animated.
pub(crate) fn parse_at(path: &Path, bytes: &[u8], lenient: bool, moment: Moment) -> Result<Raw> {
    parse_source(&Source { path, bytes, files: Files::Given(&[]), lenient }, moment)
}

/// Parses one groom file and the files that it refers to.
pub(crate) fn parse_source(source: &Source, moment: Moment) -> Result<Raw> {
    let Source { path, bytes, .. } = *source;
    if bytes.is_empty() {
        return Err(source.problem(At::Byte(0), "the file is empty"));
    }
    let format = FileFormat::of(path);
    let Some((format, read)) = format.and_then(|format| Some((format, format.read?))) else {
        return Err(match format.is_some_and(|format| format.read_mesh.is_some()) {
            true => {
                source.problem(At::File, "the file is a mesh, not a groom; use it as the head of a groom")
            }
            false => FileFormat::unread(path, "a groom", GROOMS),
        });
    };
    let raw = read(source, moment)?;
    if moment != Moment::First && !format.reads.contains(&ContentKind::Frames) {
        return Err(source.problem(At::File, "the format has no frames; a frame cannot be selected"));
    }
    if raw.strands.is_empty() {
        return Err(source.problem(At::File, "the file holds no strands"));
    }
    source.check_vertices(0, raw.strands.positions.len() as u64)?;
    Ok(raw)
}
