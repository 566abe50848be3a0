//! Types of the writers.

use super::content::Content;
use crate::{Look, Result, Rig, Strands, TriMesh, orient::Unit};
use glam::Vec3;
use std::io;

/// The writer of files with one extension.
#[derive(Clone, Copy, Debug)]
pub struct Writer {
    /// The extension, in lower case.
    pub extension: &'static str,
    /// What such a file can hold.
    pub holds: &'static [Content],
    /// Whether files may be in other units than metres.
    pub any_unit: bool,
    /// Whether hair may be compressed ([`Hair::packed`]).
    pub compresses: bool,
    /// Strands alone. The unit is that of the file, where the strands are in metres, Y up, face +Z; `None` says nothing of
    /// unit and axes.
    pub(crate) strands: fn(&Strands, Option<Unit>) -> Result<Encoded>,
    pub(crate) character: Option<WriteCharacter>,
    pub(crate) mesh: Option<WriteMesh>,
    pub(crate) cache: Option<WriteCache>,
}

impl Writer {
    /// A writer of nothing but strands in metres, for the table to add to.
    pub(super) const fn new(
        extension: &'static str,
        holds: &'static [Content],
        strands: fn(&Strands, Option<Unit>) -> Result<Encoded>,
    ) -> Self {
        let (any_unit, compresses) = (false, false);
        Self { extension, holds, any_unit, compresses, strands, character: None, mesh: None, cache: None }
    }
}

pub(super) type WriteMesh = fn(&TriMesh, Option<&Rig>) -> Result<Vec<u8>>;
pub(super) type WriteCharacter = fn(Option<(&TriMesh, Option<&Rig>)>, &[Hair<'_>]) -> Result<Vec<u8>>;
pub(super) type WriteCache =
    for<'a> fn(Box<dyn Output + 'a>, &Strands, CacheOptions) -> io::Result<Box<dyn Cache + 'a>>;

/// A file's bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Encoded {
    /// The whole file.
    pub bytes: Vec<u8>,
    /// What the format cannot hold, one clause each.
    pub notes: Vec<String>,
}

impl From<Vec<u8>> for Encoded {
    fn from(bytes: Vec<u8>) -> Self {
        Self { bytes, notes: Vec::new() }
    }
}

/// Hair of a character to be written.
#[derive(Clone, Copy, Debug)]
pub struct Hair<'a> {
    /// Its name; in USD other characters than letters, digits and underscores are replaced.
    pub name: &'a str,
    /// At rest, metres, Y up, in the space of the body.
    pub strands: &'a Strands,
    /// Whether a glTF file compresses it by `EXT_meshopt_compression`: smaller, but programs without that extension open
    /// nothing of the file.
    pub packed: bool,
    /// Its material, where one is written.
    pub look: Option<&'a Look>,
}

/// Options of a cache.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CacheOptions {
    /// The unit of the file; the strands are in metres, Y up.
    pub unit: Unit,
    /// Frames per second.
    pub rate: f64,
    /// Number of frames.
    pub frames: u32,
}

/// A cache that is being written: strands whose positions change from frame to frame. Frames are written as they come.
pub trait Cache {
    /// Writes one more frame: a position for each vertex of the strands, metres.
    ///
    /// # Errors
    /// Those of the output, and [`InvalidInput`](io::ErrorKind::InvalidInput) for another number of positions.
    fn frame(&mut self, positions: &[Vec3]) -> io::Result<()>;

    /// Ends the file.
    ///
    /// # Errors
    /// Those of the output.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// An output of caches.
pub trait Output: io::Write + io::Seek {}

impl<T: io::Write + io::Seek> Output for T {}

/// Appends numbers, little-endian.
pub(super) fn put<const N: usize>(bytes: &mut Vec<u8>, values: [f32; N]) {
    for v in values {
        bytes.extend_from_slice(&v.to_le_bytes());
    }
}
