//! Kinds of files, by name and content.

use crate::formats::{FileFormat, RESOURCES, extension};
use std::path::Path;

/// Kind of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// Strands, with or without the mesh that they grow on.
    Groom,
    /// A mesh without strands.
    Mesh,
    /// A file that a mesh may refer to: materials, buffers, textures.
    Resource,
}

/// Returns whether the groom `name` also holds a mesh, which is its head if no other is given. Such grooms are glTF
/// and USD files with hair and a visible mesh.
pub fn holds_body(name: &Path, bytes: &[u8]) -> bool {
    FileFormat::of(name).and_then(|format| format.holds_body).is_some_and(|holds| holds(name, bytes))
}

/// Returns the kind of the file `name`; `None` if no reader accepts it.
pub fn kind(name: &Path, bytes: &[u8]) -> Option<FileKind> {
    let format = FileFormat::of(name);
    let is_groom = format.and_then(|format| match (format.read, format.read_mesh) {
        (Some(_), Some(_)) => Some(format.is_groom.is_none_or(|is_groom| is_groom(name, bytes))),
        (Some(_), None) => Some(true),
        (None, Some(_)) => Some(false),
        (None, None) => None,
    });
    match is_groom {
        Some(true) => Some(FileKind::Groom),
        Some(false) => Some(FileKind::Mesh),
        None => RESOURCES.contains(&&*extension(name)).then_some(FileKind::Resource),
    }
}
