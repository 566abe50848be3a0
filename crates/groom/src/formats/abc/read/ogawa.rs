//! The container: a tree of groups, whose leaves are runs of bytes.
//!
//! Sixteen bytes of header (`Ogawa`, whether the file was finished, a version, the place of the root), then
//! groups and data in any order. A group is a count and as many places, a data is a length and as many bytes;
//! the top bit of a place tells which, and a place of 0 is an empty one.

use super::Source;
use crate::error::{At, Result};

/// The top bit of a place.
const DATA: u64 = 1 << 63;

/// A group: the places of its children.
#[derive(Clone, Copy, Default)]
pub(super) struct Group<'a> {
    places: &'a [[u8; 8]],
    /// Where it lies; 0 for an empty one.
    pub at: u64,
}

/// A leaf.
#[derive(Clone, Copy, Default)]
pub(super) struct Data<'a> {
    pub bytes: &'a [u8],
    /// Where its first byte is.
    pub at: u64,
}

/// The root of a whole file.
pub(super) fn root<'a>(source: &Source<'a>) -> Result<Group<'a>> {
    if source.bytes.starts_with(b"\x89HDF") {
        let problem =
            "an Alembic file of the old HDF5 kind; written anew by a present exporter (Ogawa) it can be read";
        return Err(source.problem(At::Byte(0), problem));
    }
    if !source.bytes.starts_with(b"Ogawa") {
        return Err(source.problem(At::Byte(0), "an .abc file starts with “Ogawa”, this one does not"));
    }
    let header = source.array("header bytes", 0, 16, 1)?;
    if header[5] != 0xff {
        return Err(source.problem(At::Byte(5), "the file was never finished by its writer"));
    }
    if header[6..8] != [0, 1] {
        let version = u16::from_be_bytes([header[6], header[7]]);
        return Err(source.problem(At::Byte(6), format!("version {version} of Ogawa, but only 1 is known")));
    }
    Group::at(source, u64_at(source, "root's place", 8)?)
}

/// Eight bytes as a number.
fn u64_at(source: &Source, what: &str, at: u64) -> Result<u64> {
    let bytes = source.array(what, at, 1, 8)?;
    Ok(bytes.as_chunks().0.first().map_or(0, |b| u64::from_le_bytes(*b)))
}

impl<'a> Group<'a> {
    fn at(source: &Source<'a>, at: u64) -> Result<Self> {
        if at == 0 {
            return Ok(Self::default());
        }
        let count = u64_at(source, "number of a group's children", at)?;
        let places = source.array("places of a group's children", at.saturating_add(8), count, 8)?;
        Ok(Self { places: places.as_chunks().0, at })
    }

    /// The number of its children.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    fn place(&self, source: &Source, child: usize, what: &str) -> Result<u64> {
        match self.places.get(child) {
            Some(place) => Ok(u64::from_le_bytes(*place)),
            None => {
                let problem = format!("{what} should be child {child} of {} of this group", self.len());
                Err(source.problem(At::Byte(self.at), problem))
            }
        }
    }

    /// A child that is a group; `what` names it in errors.
    pub fn group(&self, source: &Source<'a>, child: usize, what: &str) -> Result<Self> {
        let place = self.place(source, child, what)?;
        if place & DATA != 0 {
            return Err(
                source.problem(At::Byte(self.at), format!("{what} is data where a group is expected"))
            );
        }
        Self::at(source, place)
    }

    /// A child that is data.
    pub fn data(&self, source: &Source<'a>, child: usize, what: &str) -> Result<Data<'a>> {
        let place = self.place(source, child, what)?;
        if place & DATA == 0 {
            return Err(
                source.problem(At::Byte(self.at), format!("{what} is a group where data is expected"))
            );
        }
        let at = place & !DATA;
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

    /// Whether all is read.
    pub fn done(&self) -> bool {
        self.next >= self.data.bytes.len()
    }

    /// An error where the last read began or ended.
    pub fn problem<T>(&self, problem: impl Into<String>) -> Result<T> {
        Err(self.source.problem(At::Byte(self.data.at + self.next as u64), problem))
    }

    pub fn bytes(&mut self, count: usize) -> Result<&'a [u8]> {
        let end = self.next.checked_add(count).filter(|end| *end <= self.data.bytes.len());
        let Some(end) = end else {
            return self.problem(format!("{} end before {count} more bytes", self.what));
        };
        let bytes = &self.data.bytes[self.next..end];
        self.next = end;
        Ok(bytes)
    }

    /// A number of 1, 2, 4 or 8 bytes.
    pub fn number(&mut self, size: usize) -> Result<u64> {
        let bytes = self.bytes(size)?;
        Ok(bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte)))
    }

    pub fn f64(&mut self) -> Result<f64> {
        Ok(f64::from_bits(self.number(8)?))
    }

    /// Text of `length` bytes.
    pub fn text(&mut self, length: u64) -> Result<&'a str> {
        let bytes = self.bytes(usize::try_from(length).unwrap_or(usize::MAX))?;
        match std::str::from_utf8(bytes) {
            Ok(text) => Ok(text),
            Err(_) => self.problem(format!("a name among {} is no text", self.what)),
        }
    }
}
