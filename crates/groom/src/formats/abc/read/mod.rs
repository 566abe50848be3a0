//! The reader of Alembic.
//!
//! ```text
//! ogawa: groups, bytes ─► property: names, types, samples ─► tree: objects, transforms ─┬─► curves, groom ─► strands
//! time: when samples are                                                                └─► mesh ─► triangles
//! ```
//!
//! Objects form a tree; each has properties, and the text beside its name says by which schema they are meant.
//! Three are read: `AbcGeom_Curve`, `AbcGeom_PolyMesh` and, above them, `AbcGeom_Xform`. What Unreal calls a
//! groom are curves with further properties, `groom_*` (Epic, *Using Alembic for Grooms in Unreal Engine*, schema
//! 1.5). Everything is sampled over time: one moment of it is read ([`Moment`](crate::import::Moment)).
//!
//! The layout is that of the reference implementation (Alembic 1.8, `AbcCoreOgawa`). No crate reads it whole; this
//! does without a copy of the file, and refuses what is broken with the place where it is.

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

/// Properties and vertices that a file may ask for per byte: curves may share their points, but not a few bytes all
/// memory.
const READS_PER_BYTE: u64 = 16;

/// An open file.
pub(super) struct Archive<'s, 'a> {
    source: &'s Source<'a>,
    /// The object that holds all others.
    top: Group<'a>,
    samplings: Vec<Sampling>,
    /// Texts that many objects and properties share.
    shared: Vec<&'a str>,
    /// What the file says of itself.
    about: &'a str,
    /// How much more is read of it: parts of a file may be named again and again, but not without end.
    left: Cell<u64>,
}

impl<'s, 'a> Archive<'s, 'a> {
    fn open(source: &'s Source<'a>) -> Result<Self> {
        let root = ogawa::root(source)?;
        let text = |data: Data<'a>, what| Reader::new(source, data, what).text(data.bytes.len() as u64);
        let version = root.data(source, 0, "the layout's version")?;
        if version.bytes.len() != 4 || version.bytes[1..] != [0; 3] || version.bytes[0] > 1 {
            return Err(source.problem(At::Byte(version.at), "a layout of Alembic that is not known"));
        }
        let mut shared = vec![""];
        let mut reader = Reader::new(source, root.data(source, 5, "the shared texts")?, "the shared texts");
        while !reader.done() {
            let length = reader.number(1)?;
            shared.push(reader.text(length)?);
        }
        Ok(Self {
            source,
            top: root.group(source, 2, "the top object")?,
            samplings: time::read(source, root.data(source, 4, "the time samplings")?)?,
            shared,
            left: Cell::new(READS_PER_BYTE.saturating_mul(source.bytes.len() as u64)),
            about: text(
                root.data(source, 3, "what the file says of itself")?,
                "what the file says of itself",
            )?,
        })
    }

    /// Takes note that `count` more are read of what lies at `at`.
    fn spend(&self, count: u64, at: u64) -> Result<()> {
        match self.left.get().checked_sub(count) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => Err(self
                .source
                .problem(At::Byte(at), "the same is named more often than so small a file can mean")),
        }
    }

    /// A shared text by its number.
    fn meta(&self, reader: &Reader, index: usize) -> Result<String> {
        match self.shared.get(index) {
            Some(text) => Ok((*text).to_owned()),
            None => {
                reader.problem(format!("shared text {index} does not exist, there are {}", self.shared.len()))
            }
        }
    }

    /// Which program wrote it, where it says so.
    fn application(&self) -> Option<&'a str> {
        entry(self.about, "_ai_Application").filter(|name| !name.is_empty())
    }
}
