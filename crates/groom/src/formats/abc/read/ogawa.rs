//! The Ogawa container: a tree of groups whose leaves are byte arrays.
//!
//! A header of 16 bytes (`Ogawa`, a flag set when the file is complete, a version, the offset of the root) precedes
//! groups and data in any order. A group is a count and as many child offsets. Data is a length and as many bytes. The
//! top bit of an offset marks data; an offset of 0 is an empty group or empty data.

use super::Source;
use crate::error::{At, Result};

/// Top bit of an offset: marks data.
const DATA: u64 = 1 << 63;

/// A group: the offsets of its children.
#[derive(Clone, Copy, Default)]
pub(super) struct Group<'a> {
    offsets: &'a [[u8; 8]],
    /// Byte offset; 0 for an empty group.
    pub at: u64,
}

/// The bytes of a leaf.
#[derive(Clone, Copy, Default)]
pub(super) struct Data<'a> {
    pub bytes: &'a [u8],
    /// Byte offset of the first byte.
    pub at: u64,
}

/// Returns the root group of a file.
pub(super) fn root<'a>(source: &Source<'a>) -> Result<Group<'a>> {
    if source.bytes.starts_with(b"\x89HDF") {
        let problem = "the old HDF5 layout of Alembic is not supported; export the file again as Ogawa";
        return Err(source.problem(At::Byte(0), problem));
    }
    if !source.bytes.starts_with(b"Ogawa") {
        return Err(
            source.problem(At::Byte(0), "the file is not an .abc file: it does not start with “Ogawa”")
        );
    }
    let header = source.array("header bytes", 0, 16, 1)?;
    if header[5] != 0xff {
        return Err(source.problem(At::Byte(5), "the file is incomplete: its writer did not finish it"));
    }
    if header[6..8] != [0, 1] {
        let version = u16::from_be_bytes([header[6], header[7]]);
        return Err(
            source.problem(At::Byte(6), format!("Ogawa version {version} is not supported, only version 1"))
        );
    }
    Group::at(source, u64_at(source, "root offset", 8)?)
}

/// Reads eight bytes as an integer.
fn u64_at(source: &Source, what: &str, at: u64) -> Result<u64> {
    let bytes = source.array(what, at, 1, 8)?;
    Ok(bytes.as_chunks().0.first().map_or(0, |b| u64::from_le_bytes(*b)))
}

impl<'a> Group<'a> {
    fn at(source: &Source<'a>, at: u64) -> Result<Self> {
        if at == 0 {
            return Ok(Self::default());
        }
        let count = u64_at(source, "child count", at)?;
        let offsets = source.array("child offsets", at.saturating_add(8), count, 8)?;
        Ok(Self { offsets: offsets.as_chunks().0, at })
    }

    /// Returns the number of children.
    pub fn len(&self) -> usize {
        self.offsets.len()
    }

    fn offset(&self, source: &Source, child: usize, what: &str) -> Result<u64> {
        match self.offsets.get(child) {
            Some(offset) => Ok(u64::from_le_bytes(*offset)),
            None => {
                let problem = format!(
                    "{what} should be child {child} of this group, which has {} children",
                    self.len()
                );
                Err(source.problem(At::Byte(self.at), problem))
            }
        }
    }

    /// Returns a child that is a group; `what` names it in errors.
    pub fn group(&self, source: &Source<'a>, child: usize, what: &str) -> Result<Self> {
        let offset = self.offset(source, child, what)?;
        if offset & DATA != 0 {
            return Err(source.problem(At::Byte(self.at), format!("{what} is data, but should be a group")));
        }
        Self::at(source, offset)
    }

    /// Returns a child that is data; `what` names it in errors.
    pub fn data(&self, source: &Source<'a>, child: usize, what: &str) -> Result<Data<'a>> {
        let offset = self.offset(source, child, what)?;
        if offset & DATA == 0 {
            return Err(source.problem(At::Byte(self.at), format!("{what} is a group, but should be data")));
        }
        let at = offset & !DATA;
        if at == 0 {
            return Ok(Data::default());
        }
        let length = u64_at(source, &format!("length of {what}"), at)?;
        Ok(Data {
            bytes: source.array(&format!("bytes of {what}"), at.saturating_add(8), length, 1)?,
            at: at.saturating_add(8),
        })
    }
}

/// Reads a leaf from front to back.
pub(super) struct Reader<'s, 'a> {
    source: &'s Source<'a>,
    data: Data<'a>,
    next: usize,
    what: &'static str,
}

impl<'s, 'a> Reader<'s, 'a> {
    pub fn new(source: &'s Source<'a>, data: Data<'a>, what: &'static str) -> Self {
        Self { source, data, next: 0, what }
    }

    /// Returns whether all bytes have been read.
    pub fn done(&self) -> bool {
        self.next >= self.data.bytes.len()
    }

    /// Returns an error at the current byte.
    pub fn problem<T>(&self, problem: impl Into<String>) -> Result<T> {
        Err(self.source.problem(At::Byte(self.data.at + self.next as u64), problem))
    }

    pub fn bytes(&mut self, count: usize) -> Result<&'a [u8]> {
        let end = self.next.checked_add(count).filter(|end| *end <= self.data.bytes.len());
        let Some(end) = end else {
            return self.problem(format!("{} should have {count} more bytes", self.what));
        };
        let bytes = &self.data.bytes[self.next..end];
        self.next = end;
        Ok(bytes)
    }

    /// Reads an integer of 1, 2, 4 or 8 bytes.
    pub fn number(&mut self, size: usize) -> Result<u64> {
        let bytes = self.bytes(size)?;
        Ok(bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte)))
    }

    pub fn f64(&mut self) -> Result<f64> {
        Ok(f64::from_bits(self.number(8)?))
    }

    /// Reads text of `length` bytes.
    pub fn text(&mut self, length: u64) -> Result<&'a str> {
        let bytes = self.bytes(usize::try_from(length).unwrap_or(usize::MAX))?;
        match std::str::from_utf8(bytes) {
            Ok(text) => Ok(text),
            Err(_) => self.problem(format!("{} contain a name that is not valid UTF-8", self.what)),
        }
    }
}
