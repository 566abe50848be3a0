//! Writers: `.hair`, `.tfx` version 4, OBJ polylines, `.data`, PLY lines and Alembic for strands, GLB and USD (text, and
//! with the feature `usd` binary) for strands and bodies.
//!
//! Reading a written file back gives the same strands, bit for bit, but for GLB, whose positions may be shares of a box in
//! 16 bits; what a format cannot hold is listed in
//! [`Encoded::notes`]. A groom in metres, Y up, face +Z is marked as such in the file, so that nothing
//! needs to be guessed later; only `.data` has no place for that.

#[cfg(feature = "alembic")]
pub mod abc;
mod data;
#[cfg(feature = "gltf")]
pub mod glb;
mod hair;
mod obj_lines;
mod ply;
mod tfx;
pub mod usda;

#[cfg(feature = "usd")]
pub(crate) use usda::DOC as USD_DOC;

use std::path::Path;

use super::Strands;
use crate::{
    error::{At, Error, Result},
    formats,
    orient::Unit,
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
    /// Strands as USC-HairSalon has them: positions.
    Data,
    /// PLY lines: positions, widths.
    Ply,
    /// glTF, binary, with `EXT_tresses_hair`: what Alembic has.
    #[cfg(feature = "gltf")]
    Glb,
    /// Alembic: positions, widths, colours, scalp texture coordinates, guides, groups.
    #[cfg(feature = "alembic")]
    Abc,
    /// USD as text: what Alembic has.
    Usda,
    /// USD, binary: the same.
    #[cfg(feature = "usd")]
    Usdc,
}

impl Format {
    /// By a path's extension.
    pub fn of(path: &Path) -> Result<Self> {
        match formats::extension(path).as_str() {
            "hair" => Ok(Self::Hair),
            "tfx" => Ok(Self::Tfx),
            "obj" => Ok(Self::Obj),
            "data" => Ok(Self::Data),
            "ply" => Ok(Self::Ply),
            #[cfg(feature = "gltf")]
            "glb" => Ok(Self::Glb),
            #[cfg(feature = "alembic")]
            "abc" => Ok(Self::Abc),
            "usda" => Ok(Self::Usda),
            #[cfg(feature = "usd")]
            "usdc" => Ok(Self::Usdc),
            #[cfg(feature = "cooked")]
            "tresses" => Err(Error::File {
                path: path.to_path_buf(),
                at: At::File,
                problem: "a cooked groom is made of files, by `tresses convert`".into(),
            }),
            _ => Err(Error::File {
                path: path.to_path_buf(),
                at: At::File,
                problem: format!("a groom is written as {}", formats::listed(formats::WRITTEN, "or")),
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

/// [`encode`] in another unit than metres, which Alembic and USD files can be in.
///
/// # Errors
/// As [`encode`], and [`Error::Unusable`] for a format that is written in metres only.
pub fn encode_in(strands: &Strands, format: Format, unit: Unit) -> Result<Encoded> {
    match format {
        _ if unit.0 == 1.0 => encode(strands, format, true),
        #[cfg(feature = "alembic")]
        Format::Abc if !strands.is_empty() => {
            abc::encode(strands, abc::Options { unit, ..Default::default() })
        }
        Format::Usda if !strands.is_empty() => Ok(usda::encode(strands, Some(unit))),
        #[cfg(feature = "usd")]
        Format::Usdc if !strands.is_empty() => packed(usda::encode(strands, Some(unit))),
        _ => Err(Error::Unusable("only Alembic and USD files are written in other units than metres".into())),
    }
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
        Format::Data => data::encode(strands, oriented),
        Format::Ply => Ok(ply::encode(strands, oriented)),
        #[cfg(feature = "gltf")]
        Format::Glb if !oriented => {
            Err(Error::Unusable("a .glb is in metres, Y up, face +Z, which this groom may not be".into()))
        }
        #[cfg(feature = "gltf")]
        Format::Glb => {
            let bytes = glb::character(None, &[glb::Hair { name: "", strands, packed: false, look: None }])?;
            Ok(Encoded { bytes, notes: Vec::new() })
        }
        #[cfg(feature = "alembic")]
        Format::Abc => abc::encode(strands, abc::Options { oriented, ..Default::default() }),
        Format::Usda => Ok(usda::encode(strands, oriented.then_some(Unit(1.0)))),
        #[cfg(feature = "usd")]
        Format::Usdc => packed(usda::encode(strands, oriented.then_some(Unit(1.0)))),
    }
}

#[cfg(feature = "usd")]
fn packed(text: Encoded) -> Result<Encoded> {
    Ok(Encoded { bytes: usda::packed(&text.bytes)?, ..text })
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
