//! What a file is, by its name and content.

use crate::formats::{COMPANIONS, Format, extension};
use std::path::Path;

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Strands, with or without the body that they grow on.
    Groom,
    /// A mesh without strands.
    Mesh,
    /// A file that a mesh may need beside it: materials, buffers, textures.
    Companion,
}

/// Whether the groom called `name` holds a body too, which is its head where no other is given: a glTF file may hold both,
/// and a USD file whose hair and body are on a skeleton, or that we wrote.
pub fn holds_body(name: &Path, bytes: &[u8]) -> bool {
    Format::of(name).and_then(|format| format.holds_body).is_some_and(|holds| holds(name, bytes))
}

/// What the file called `name` is, or `None` for one that no reader takes.
pub fn kind(name: &Path, bytes: &[u8]) -> Option<Kind> {
    let format = Format::of(name);
    let is_groom = format.and_then(|format| match (format.read, format.read_mesh) {
        (Some(_), Some(_)) => Some(format.is_groom.is_none_or(|is_groom| is_groom(name, bytes))),
        (Some(_), None) => Some(true),
        (None, Some(_)) => Some(false),
        (None, None) => None,
    });
    match is_groom {
        Some(true) => Some(Kind::Groom),
        Some(false) => Some(Kind::Mesh),
        None => COMPANIONS.contains(&&*extension(name)).then_some(Kind::Companion),
    }
}
