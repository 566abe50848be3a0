//! Alembic reader.
//!
//! ```text
//! ogawa: groups, bytes ─► property: names, types, samples ─► tree: objects, transforms ─┬─► curves, groom ─► strands
//! time: times of samples                                                                └─► mesh ─► triangles
//! ```
//!
//! Objects form a tree. Each has properties, and its metadata names its schema. The reader supports `AbcGeom_Curve`,
//! `AbcGeom_PolyMesh` and, above them, `AbcGeom_Xform`. Unreal's grooms are curves with further properties, `groom_*`
//! (Epic, *Using Alembic for Grooms in Unreal Engine*, schema 1.5). All values are sampled over time; the reader takes
//! one moment ([`Moment`](crate::import::Moment)).
//!
//! The layout follows the reference implementation (Alembic 1.8, `AbcCoreOgawa`). No crate reads all of it. This reader
//! does not copy the file, and its errors state the position of invalid data.

mod curves;
mod groom;
mod mesh;
mod ogawa;
mod property;
#[cfg(test)]
mod tests;
mod time;
mod tree;
mod xform;

pub(crate) use curves::read;
pub(crate) use mesh::read as read_mesh;

use std::cell::Cell;

use crate::{
    error::{At, Result},
    formats::source::Source,
};
use ogawa::{Data, Group, Reader};
use property::entry;
use time::Sampling;

/// Maximum properties and vertices to read per byte of the file. Curves may share points, but a few bytes must not fill
/// the memory.
const READS_PER_BYTE: u64 = 16;

/// An open file.
pub(super) struct Archive<'s, 'a> {
    source: &'s Source<'a>,
    /// Root of the object tree.
    top: Group<'a>,
    samplings: Vec<Sampling>,
    /// Metadata strings that many objects and properties share.
    shared: Vec<&'a str>,
    /// Metadata of the file.
    about: &'a str,
    /// Remaining budget of properties and vertices. Parts of a file may be referenced repeatedly, but not without
    /// limit.
    left: Cell<u64>,
}

impl<'s, 'a> Archive<'s, 'a> {
    fn open(source: &'s Source<'a>) -> Result<Self> {
        let root = ogawa::root(source)?;
        let text = |data: Data<'a>, what| Reader::new(source, data, what).text(data.bytes.len() as u64);
        let version = root.data(source, 0, "the layout version")?;
        if version.bytes.len() != 4 || version.bytes[1..] != [0; 3] || version.bytes[0] > 1 {
            return Err(source.problem(At::Byte(version.at), "the Alembic layout version is not supported"));
        }
        let mut shared = vec![""];
        let mut reader =
            Reader::new(source, root.data(source, 5, "the shared strings")?, "the shared strings");
        while !reader.done() {
            let length = reader.number(1)?;
            shared.push(reader.text(length)?);
        }
        Ok(Self {
            source,
            top: root.group(source, 2, "the root object")?,
            samplings: time::read(source, root.data(source, 4, "the time samplings")?)?,
            shared,
            left: Cell::new(READS_PER_BYTE.saturating_mul(source.bytes.len() as u64)),
            about: text(root.data(source, 3, "the file's metadata")?, "the file's metadata")?,
        })
    }

    /// Subtracts `count` items, which lie at byte `at`, from the budget.
    fn spend(&self, count: u64, at: u64) -> Result<()> {
        match self.left.get().checked_sub(count) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => Err(self
                .source
                .problem(At::Byte(at), "the file refers to the same data too often for its size")),
        }
    }

    /// Returns a shared string by its index.
    fn meta(&self, reader: &Reader, index: usize) -> Result<String> {
        match self.shared.get(index) {
            Some(text) => Ok((*text).to_owned()),
            None => reader
                .problem(format!("shared string {index} does not exist; there are {}", self.shared.len())),
        }
    }

    /// Returns the name of the program that wrote the file, if the file states it.
    fn application(&self) -> Option<&'a str> {
        entry(self.about, "_ai_Application").filter(|name| !name.is_empty())
    }
}
