//! Cooked grooms, `.tresses`: what opening a groom computes, computed once.
//!
//! ```text
//! magic (8) │ version u32 │ CRC-32 of the rest u32 │ version of this crate │ Cooked, by serde and postcard
//! ```
//!
//! Strands are oriented and repaired, the head's distance field and its coarser meshes are made, strands are bound to
//! guides; long arrays lie there as they do in memory ([`bulk`](crate::bulk)). Reading copies and checks: whatever the bytes, what
//! comes out is as the rest of the crate leaves a groom, or an error ([`Cooked::check`]).
//!
//! A cooked groom belongs to the version of this crate that wrote it: what is computed may change without a change of its
//! layout. It is made for opening, not for keeping: it says what it was made of, and another version asks for that to be
//! cooked again. Interchange is what `.glb` and `.abc` are for.
//!
//! **Why not a cache?** A cache helps whoever opened the file before, on that machine. Games and pages are opened by
//! people who never did.

mod check;
#[cfg(test)]
mod tests;

use crate::{
    BindOptions, Followers, Groom, Look, Rig, SdfGrid, Strands, TriMesh, bind,
    error::{At, Error, Result},
    lint, mesh, orient,
    report::{Attributes, FileReport, Group, ImportReport},
};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version of the format that is read and written: it changes with any type in a [`Cooked`], and between releases with
/// how any of it is computed.
pub const VERSION: u32 = 2;
/// The version of Tresses.
const TRESSES: &str = env!("CARGO_PKG_VERSION");
/// The first bytes: none that a text has, and a line's end that transfers as text would change.
const MAGIC: [u8; 8] = *b"\x89TRESS\r\n";
/// Bytes before what the checksum is of.
pub const HEADER: usize = 16;
/// As reports call it.
const FORMAT: &str = "Tresses, cooked";

/// A groom with all that is computed when it is opened, in metres, Y up, face towards +Z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cooked {
    /// Oriented and repaired.
    pub strands: Strands,
    /// What they grow on.
    pub head: Option<TriMesh>,
    /// The head's coarser meshes, [`TriMesh::levels`].
    pub levels: Vec<mesh::Level>,
    /// What hair collides with: the head or, of one that bends, the part that hair goes with.
    pub field: Option<SdfGrid>,
    /// What bends the head.
    pub rig: Option<Rig>,
    /// Of a head that bends, its other parts that hair collides with, each with the node of the rig that carries it.
    pub parts: Vec<(u32, SdfGrid)>,
    /// The strands bound by [`BindOptions::default`].
    pub groom: Groom,
    said: Said,
}

/// What a report says besides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Said {
    sources: Vec<String>,
    placement: orient::Placement,
    head_placement: Option<orient::Placement>,
    lint: lint::Report,
    repaired: lint::Repaired,
    followers: Vec<Followers>,
    groups: Vec<Group>,
    attributes: Attributes,
    look: Option<Look>,
}

impl Cooked {
    /// Of `strands` and `head` as [`import::read_whole`](crate::import::read_whole) gives them with `report`; `field` is
    /// what they collide with. There are no [parts](Self::parts) yet.
    ///
    /// # Errors
    /// As [`bind`].
    pub fn new(
        strands: Strands,
        head: Option<TriMesh>,
        field: Option<SdfGrid>,
        rig: Option<Rig>,
        report: &ImportReport,
    ) -> Result<Self> {
        let groom = bind(&strands, &BindOptions::default())?;
        let levels = head.as_ref().map_or(Vec::new(), TriMesh::levels);
        let source = |file: &FileReport| {
            let name = file.path.file_name().unwrap_or_default().to_string_lossy();
            let told: String = file.notes.iter().map(|note| format!(", {note}")).collect();
            format!("made of {name} ({}){told}", file.format)
        };
        let said = Said {
            sources: report.files.iter().map(source).collect(),
            placement: report.placement.clone(),
            head_placement: report.head_placement.clone(),
            lint: report.lint.clone(),
            repaired: report.repaired,
            followers: report.followers.clone(),
            groups: report.groups.clone(),
            attributes: report.attributes,
            look: report.look,
        };
        Ok(Self { strands, head, levels, field, rig, parts: Vec::new(), groom, said })
    }

    /// The file.
    ///
    /// # Errors
    /// [`Error::Unusable`] when it would not be read again.
    pub fn write(&self) -> Result<Vec<u8>> {
        self.check().map_err(|problem| Error::Unusable(format!("it cannot be cooked: {problem}")))?;
        self.encode()
    }

    fn encode(&self) -> Result<Vec<u8>> {
        let body =
            postcard::to_allocvec(&(TRESSES, self)).map_err(|error| Error::Unusable(error.to_string()))?;
        let mut bytes = Vec::with_capacity(HEADER + body.len());
        bytes.extend_from_slice(&MAGIC);
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(&crc32fast::hash(&body).to_le_bytes());
        bytes.extend_from_slice(&body);
        Ok(bytes)
    }

    /// From a file's bytes; `path` stands in errors.
    ///
    /// # Errors
    /// [`Error::File`] when it is of another version, damaged, or not a cooked groom.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self> {
        let wrong = |at, problem: String| Error::File { path: path.to_path_buf(), at, problem };
        let Some((header, body)) = bytes.split_first_chunk::<HEADER>().filter(|(h, _)| h[..8] == MAGIC)
        else {
            return Err(wrong(At::Byte(0), "no cooked groom begins like this".into()));
        };
        let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| header[at + i]));
        if word(8) != VERSION {
            let problem = format!(
                "a cooked groom of version {}, where this Tresses reads version {VERSION}: cook it again",
                word(8)
            );
            return Err(wrong(At::Byte(8), problem));
        }
        if word(12) != crc32fast::hash(body) {
            return Err(wrong(At::File, "damaged: its checksum is that of other bytes".into()));
        }
        let none = |error| wrong(At::File, format!("no cooked groom comes of it: {error}"));
        let (of, body): (&str, _) = postcard::take_from_bytes(body).map_err(none)?;
        if of != TRESSES {
            let problem = format!("cooked by Tresses {of}, where this is {TRESSES}: cook it again");
            return Err(wrong(At::Byte(HEADER as u64), problem));
        }
        let (cooked, left): (Self, _) = postcard::take_from_bytes(body).map_err(none)?;
        if !left.is_empty() {
            return Err(wrong(At::Byte((bytes.len() - left.len()) as u64), "more bytes than a groom".into()));
        }
        cooked.check().map_err(|problem| wrong(At::File, problem))?;
        Ok(cooked)
    }

    /// What is told of it when it is opened as `path`; the rig stays where it is.
    pub fn report(&self, path: &Path) -> ImportReport {
        let said = self.said.clone();
        let file = FileReport {
            path: path.to_path_buf(),
            format: FORMAT,
            strands: self.strands.len(),
            vertices: self.strands.positions.len(),
            notes: said.sources,
        };
        ImportReport {
            files: vec![file],
            placement: said.placement,
            head_placement: said.head_placement,
            rig: None,
            lint: said.lint,
            repaired: said.repaired,
            followers: said.followers,
            groups: said.groups,
            attributes: said.attributes,
            look: said.look,
        }
    }
}
