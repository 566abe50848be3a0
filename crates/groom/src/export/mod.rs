//! Writers: `.hair`, `.tfx` version 4 and OBJ polylines for strands, GLB for bodies.
//!
//! Reading a written file back gives the same strands, bit for bit; what a format cannot hold is listed in
//! [`Encoded::notes`]. A groom in metres, Y up, face +Z is marked as such in the file, so that nothing
//! needs to be guessed later.

#[cfg(feature = "gltf")]
pub mod glb;
mod hair;
mod obj_lines;
mod tfx;

use std::path::Path;

use super::Strands;
use crate::{
    error::{At, Error, Result},
    formats,
};

/// A format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Cem Yuksel's `.hair`: positions, widths, colours.
    Hair,
    /// TressFX 4 `.tfx`: positions, pinned tips, scalp texture coordinates, colours.
    Tfx,
    /// OBJ polylines: positions.
    Obj,
}

impl Format {
    /// By a path's extension.
    pub fn of(path: &Path) -> Result<Self> {
        match formats::extension(path).as_str() {
            "hair" => Ok(Self::Hair),
            "tfx" => Ok(Self::Tfx),
            "obj" => Ok(Self::Obj),
            _ => Err(Error::File {
                path: path.to_path_buf(),
                at: At::File,
                problem: format!("a groom is written as {}", formats::listed(formats::GROOMS, "or")),
            }),
        }
    }
}

/// A file's bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Encoded {
    /// The whole file.
    pub bytes: Vec<u8>,
    /// What the format could not hold, one clause each.
    pub notes: Vec<String>,
}

/// Strands as a file's bytes. `oriented` says that they are in metres, Y up, face +Z.
pub fn encode(strands: &Strands, format: Format, oriented: bool) -> Result<Encoded> {
    if strands.is_empty() {
        return Err(Error::Unusable("a groom without strands is not written".into()));
    }
    match format {
        Format::Hair => hair::encode(strands, oriented),
        Format::Tfx => tfx::encode(strands, oriented),
        Format::Obj => Ok(obj_lines::encode(strands, oriented)),
    }
}

fn lost(notes: &mut Vec<String>, any: bool, what: &str) {
    if any {
        notes.push(format!("the format has no place for {what}, so it is left out"));
    }
}

fn put<const N: usize>(bytes: &mut Vec<u8>, values: [f32; N]) {
    for v in values {
        bytes.extend_from_slice(&v.to_le_bytes());
    }
}
