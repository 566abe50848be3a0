//! Writer types.

use super::content::ContentKind;
use crate::{Look, Result, Rig, Strands, TriMesh, orient::LengthUnit};
use glam::Vec3;
use std::io;

/// The writer of files with one extension.
#[derive(Clone, Copy, Debug)]
pub struct Writer {
    /// Lowercase extension.
    pub extension: &'static str,
    /// Contents that such files can hold.
    pub holds: &'static [ContentKind],
    /// Whether files may be in units other than meters.
    pub any_unit: bool,
    /// Whether hair can be compressed ([`ExportHair::packed`]).
    pub compresses: bool,
    /// Encodes strands, which are in meters, Y up, face +Z, as a file in the given unit. With `None` the file states
    /// neither unit nor axes.
    pub(crate) strands: fn(&Strands, Option<LengthUnit>) -> Result<EncodedFile>,
    pub(crate) character: Option<WriteCharacter>,
    pub(crate) mesh: Option<WriteMesh>,
    pub(crate) cache: Option<WriteCache>,
}

impl Writer {
    /// Returns a writer that supports only strands in meters; rows of the table add more.
    pub(super) const fn new(
        extension: &'static str,
        holds: &'static [ContentKind],
        strands: fn(&Strands, Option<LengthUnit>) -> Result<EncodedFile>,
    ) -> Self {
        let (any_unit, compresses) = (false, false);
        Self { extension, holds, any_unit, compresses, strands, character: None, mesh: None, cache: None }
    }
}

pub(super) type WriteMesh = fn(&TriMesh, Option<&Rig>) -> Result<Vec<u8>>;
pub(super) type WriteCharacter = fn(Option<(&TriMesh, Option<&Rig>)>, &[ExportHair<'_>]) -> Result<Vec<u8>>;
pub(super) type WriteCache =
    for<'a> fn(Box<dyn CacheSink + 'a>, &Strands, CacheOptions) -> io::Result<Box<dyn CacheWriter + 'a>>;

/// An encoded file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EncodedFile {
    /// The whole file.
    pub bytes: Vec<u8>,
    /// Notes on data that the format cannot hold, one clause each.
    pub notes: Vec<String>,
}

impl From<Vec<u8>> for EncodedFile {
    fn from(bytes: Vec<u8>) -> Self {
        Self { bytes, notes: Vec::new() }
    }
}

/// Hair of a character to be written.
#[derive(Clone, Copy, Debug)]
pub struct ExportHair<'a> {
    /// Name. USD replaces characters other than letters, digits and underscores.
    pub name: &'a str,
    /// Strands at rest, meters, Y up, in the mesh's space.
    pub strands: &'a Strands,
    /// Whether a glTF file compresses the strands with `EXT_meshopt_compression`. The file is smaller, but programs
    /// without the extension cannot open it.
    pub packed: bool,
    /// Hair material, if the file stores one.
    pub look: Option<&'a Look>,
}

/// Options of a cache.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CacheOptions {
    /// Unit of the file. The strands are in meters, Y up.
    pub unit: LengthUnit,
    /// Frames per second.
    pub rate: f64,
    /// Number of frames.
    pub frames: u32,
}

/// A cache being written: strands whose positions change from frame to frame. Each frame is written immediately.
pub trait CacheWriter {
    /// Writes a frame: one position per vertex of the strands, meters.
    ///
    /// # Errors
    /// The errors of the output, and [`InvalidInput`](io::ErrorKind::InvalidInput) for a wrong number of positions.
    fn frame(&mut self, positions: &[Vec3]) -> io::Result<()>;

    /// Ends the file.
    ///
    /// # Errors
    /// The errors of the output.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// An output of caches.
pub trait CacheSink: io::Write + io::Seek {}

impl<T: io::Write + io::Seek> CacheSink for T {}

/// Appends little-endian numbers.
pub(super) fn put<const N: usize>(bytes: &mut Vec<u8>, values: [f32; N]) {
    for v in values {
        bytes.extend_from_slice(&v.to_le_bytes());
    }
}
