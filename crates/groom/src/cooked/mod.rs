//! Cooked grooms, `.tresses`: the results of opening a groom, computed once and stored.
//!
//! ```text
//! magic (8) │ version u32 │ CRC-32 of the rest u32 │ version of this crate │ CookedGroom, by serde and postcard
//! ```
//!
//! Strands are stored oriented, repaired and bound to guides, with the head's distance field and its coarser meshes.
//! Long arrays have their in-memory layout (`bulk`). Reading copies and validates: for any input,
//! [`CookedGroom::read`] returns either a valid groom or an error (`CookedGroom::check`).
//!
//! Only the version of this crate that wrote a cooked groom can read it, because computations may change while the
//! layout stays the same. The format is for fast opening, not for archiving. A file lists its sources; another version
//! of the crate returns an error that asks for it to be cooked again. For interchange use `.glb` or `.abc`.
//!
//! **Why not a cache?** A cache helps only on a machine that has opened the file before. Players of a game and visitors
//! of a web page open it for the first time.

mod check;
#[cfg(test)]
mod tests;

use crate::{
    BindOptions, Followers, Groom, Look, Rig, SdfGrid, Strands, TriMesh, bind,
    error::{At, Error, Result},
    light::PunctualLight,
    lint, mesh, orient,
    report::{Attributes, FileReport, ImportReport, StrandGroup},
};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the format. Increase it when a type in [`CookedGroom`] changes and, between releases, when a stored value
/// is computed differently.
pub const VERSION: u32 = 4;
/// Version of this crate.
const TRESSES: &str = env!("CARGO_PKG_VERSION");
/// Magic bytes. Text cannot begin with `\x89`, and a transfer in text mode would change the line ending.
const MAGIC: [u8; 8] = *b"\x89TRESS\r\n";
/// Size of the header, bytes. The checksum covers everything after it.
pub const HEADER: usize = 16;
/// Format name in reports.
const FORMAT: &str = "Tresses, cooked";

/// A groom with everything that opening it computes, in meters, Y up, face +Z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CookedGroom {
    /// Strands, oriented and repaired.
    pub strands: Strands,
    /// Head mesh that the strands grow on.
    pub head: Option<TriMesh>,
    /// Coarser meshes of the head ([`TriMesh::levels`]).
    pub levels: Vec<mesh::MeshLevel>,
    /// Collision field of the head. For a skinned head: of the part that carries the hair.
    pub field: Option<SdfGrid>,
    /// Rig that deforms the head.
    pub rig: Option<Rig>,
    /// Further collision fields of a skinned head, each with the rig node that carries it.
    pub parts: Vec<(u32, SdfGrid)>,
    /// The strands bound to guides with [`BindOptions::default`].
    pub groom: Groom,
    report_text: ReportText,
}

/// Contents of the [`ImportReport`] besides the fields of [`CookedGroom`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ReportText {
    sources: Vec<String>,
    placement: orient::Placement,
    head_placement: Option<orient::Placement>,
    lint: lint::LintReport,
    repaired: lint::RepairReport,
    followers: Vec<Followers>,
    groups: Vec<StrandGroup>,
    attributes: Attributes,
    look: Option<Look>,
    lights: Vec<PunctualLight>,
}

impl CookedGroom {
    /// Binds `strands` and computes the head's coarser meshes. [`import::read_complete`](crate::import::read_complete)
    /// returns `strands`, `head` and `report`; `field` is the strands' collision field. [`Self::parts`] stays empty.
    ///
    /// # Errors
    /// See [`bind()`].
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
            let notes: String = file.notes.iter().map(|note| format!(", {note}")).collect();
            format!("made of {name} ({}){notes}", file.format)
        };
        let report_text = ReportText {
            sources: report.files.iter().map(source).collect(),
            placement: report.placement.clone(),
            head_placement: report.head_placement.clone(),
            lint: report.lint.clone(),
            repaired: report.repaired,
            followers: report.followers.clone(),
            groups: report.groups.clone(),
            attributes: report.attributes.clone(),
            look: report.look,
            lights: report.lights.clone(),
        };
        Ok(Self { strands, head, levels, field, rig, parts: Vec::new(), groom, report_text })
    }

    /// Encodes the groom as a file.
    ///
    /// # Errors
    /// [`Error::Unusable`] if [`Self::read`] would reject the file.
    pub fn write(&self) -> Result<Vec<u8>> {
        self.check().map_err(|problem| Error::Unusable(format!("the groom cannot be cooked: {problem}")))?;
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

    /// Reads a groom from a file's bytes. Error messages name `path`.
    ///
    /// # Errors
    /// [`Error::File`] if the file has another version, is damaged, or is not a cooked groom.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self> {
        let wrong = |at, problem: String| Error::File { path: path.to_path_buf(), at, problem };
        let Some((header, body)) = bytes.split_first_chunk::<HEADER>().filter(|(h, _)| h[..8] == MAGIC)
        else {
            return Err(wrong(
                At::Byte(0),
                "the file is not a cooked groom: its first bytes are wrong".into(),
            ));
        };
        let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| header[at + i]));
        if word(8) != VERSION {
            let problem = format!(
                "the file has format version {}, but this Tresses reads version {VERSION}; cook it again",
                word(8)
            );
            return Err(wrong(At::Byte(8), problem));
        }
        if word(12) != crc32fast::hash(body) {
            return Err(wrong(At::File, "the file is damaged: its checksum does not match".into()));
        }
        let none = |error| wrong(At::File, format!("the contents cannot be decoded: {error}"));
        let (of, body): (&str, _) = postcard::take_from_bytes(body).map_err(none)?;
        if of != TRESSES {
            let problem = format!("cooked by Tresses {of}, but this is Tresses {TRESSES}; cook it again");
            return Err(wrong(At::Byte(HEADER as u64), problem));
        }
        let (cooked, left): (Self, _) = postcard::take_from_bytes(body).map_err(none)?;
        if !left.is_empty() {
            return Err(wrong(
                At::Byte((bytes.len() - left.len()) as u64),
                "unexpected bytes after the groom".into(),
            ));
        }
        cooked.check().map_err(|problem| wrong(At::File, problem))?;
        Ok(cooked)
    }

    /// Returns the import report for the groom, opened as `path`. [`ImportReport::rig`] is `None`: the rig stays in
    /// `self`.
    pub fn report(&self, path: &Path) -> ImportReport {
        let text = self.report_text.clone();
        let file = FileReport {
            path: path.to_path_buf(),
            format: FORMAT,
            strands: self.strands.len(),
            vertices: self.strands.positions.len(),
            notes: text.sources,
        };
        ImportReport {
            files: vec![file],
            placement: text.placement,
            head_placement: text.head_placement,
            rig: None,
            lights: text.lights,
            lint: text.lint,
            repaired: text.repaired,
            followers: text.followers,
            groups: text.groups,
            attributes: text.attributes,
            look: text.look,
        }
    }
}
