//! Files on disk or in memory, and bounds-checked reads of a file's bytes.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

use glam::{Vec2, Vec3};

use crate::{
    MAX_VERTICES,
    error::{At, Error, Result},
};

/// A file in memory: its name, whose extension decides the format, and its bytes.
pub type FileBytes<'a> = (PathBuf, Cow<'a, [u8]>);

/// Where files are read from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Files<'a> {
    /// The file system.
    Disk,
    /// Only these files, for example in a browser.
    Given(&'a [FileBytes<'a>]),
    /// Files that are remembered as they are read.
    #[cfg(feature = "edit")]
    Recorded(&'a RecordedFiles<'a>),
}

/// Files, and those of them that have been read.
#[cfg(feature = "edit")]
#[derive(Debug)]
pub(crate) struct RecordedFiles<'a> {
    pub from: Files<'a>,
    pub read: std::sync::Mutex<Vec<(PathBuf, std::sync::Arc<[u8]>)>>,
}

impl<'a> Files<'a> {
    /// Reads a whole file; an error names it.
    pub fn load(self, path: &Path) -> Result<Cow<'a, [u8]>> {
        match self {
            Self::Disk => match std::fs::read(path) {
                Ok(bytes) => Ok(Cow::Owned(bytes)),
                Err(source) => Err(Error::Io { path: path.to_path_buf(), source }),
            },
            Self::Given(all) => {
                // A file that the user dropped or picked has lost its folder.
                let found = all.iter().find(|(name, _)| name == path);
                let found =
                    found.or_else(|| all.iter().find(|(name, _)| name.file_name() == path.file_name()));
                let missing = || Error::Io {
                    path: path.to_path_buf(),
                    source: std::io::Error::new(std::io::ErrorKind::NotFound, "the file was not provided"),
                };
                found.map(|(_, bytes)| Cow::Borrowed(&**bytes)).ok_or_else(missing)
            }
            #[cfg(feature = "edit")]
            Self::Recorded(files) => {
                let bytes = files.from.load(path)?;
                let mut read = files.read.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                if read.iter().all(|(name, _)| name != path) {
                    read.push((path.to_path_buf(), (&*bytes).into()));
                }
                drop(read);
                Ok(bytes)
            }
        }
    }
}

/// A whole file in memory. Sizes in a header are checked against these bytes, so no allocation is larger than the file
/// justifies.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub path: &'a Path,
    pub bytes: &'a [u8],
    /// Where files that this one refers to are read from.
    pub files: Files<'a>,
    /// Whether numbers may be infinite or NaN, so that a lint can count them.
    pub lenient: bool,
}

impl<'a> Source<'a> {
    /// Reads the file `name` that this one refers to.
    pub fn resource(&self, name: &str) -> Result<Cow<'a, [u8]>> {
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        self.files.load(&path).map_err(|error| match self.files {
            Files::Disk => error,
            #[cfg(feature = "edit")]
            Files::Recorded(_) => error,
            Files::Given(_) => {
                self.problem(At::File, format!("the file needs {name}; provide both together"))
            }
        })
    }

    pub fn problem(&self, at: At, problem: impl Into<String>) -> Error {
        Error::File { path: self.path.to_path_buf(), at, problem: problem.into() }
    }

    /// Returns `count` items of `size` bytes from byte `offset`; `what` names them in the error.
    pub fn array(&self, what: &str, offset: u64, count: u64, size: u64) -> Result<&'a [u8]> {
        let length = self.bytes.len() as u64;
        let end = count.checked_mul(size).and_then(|n| n.checked_add(offset));
        match end {
            Some(end) if end <= length => Ok(&self.bytes[offset as usize..end as usize]),
            _ if offset > length => Err(self.problem(
                At::Byte(length),
                format!("the file ends here, but the {what} should start at byte {offset}"),
            )),
            _ => Err(self.problem(
                At::Byte(length),
                format!("the file ends here, before the end of {count} {what} from byte {offset}"),
            )),
        }
    }

    /// Rejects numbers that are not finite, unless the source is lenient; `what` names them.
    #[cfg(feature = "usd")]
    pub fn check_finite(&self, at: At, numbers: &[f32], what: &str) -> Result<()> {
        match numbers.iter().find(|number| !number.is_finite()) {
            Some(value) if !self.lenient => {
                Err(self.problem(at, format!("a value of the {what} is {value}, but must be finite")))
            }
            _ => Ok(()),
        }
    }

    /// Rejects more vertices than any GPU buffer can hold, before they are counted in 32 bits.
    pub fn check_vertices(&self, at: u64, count: u64) -> Result<()> {
        if count <= MAX_VERTICES {
            return Ok(());
        }
        let problem = format!(
            "the groom has {count} vertices, more than the {MAX_VERTICES} that fit in the largest GPU buffer"
        );
        Err(self.problem(At::Byte(at), problem))
    }

    pub fn u32(&self, what: &str, offset: u64) -> Result<u32> {
        let bytes = self.array(what, offset, 1, 4)?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    pub fn f32(&self, what: &str, offset: u64) -> Result<f32> {
        Ok(f32::from_bits(self.u32(what, offset)?))
    }

    /// Returns `count` groups of `N` floats from byte `offset`, finite unless the source is lenient.
    pub fn floats<const N: usize>(&self, what: &str, offset: u64, count: u64) -> Result<Vec<[f32; N]>> {
        let bytes = self.array(what, offset, count, 4 * N as u64)?;
        let mut all = Vec::with_capacity(count as usize);
        for (i, group) in bytes.chunks_exact(4 * N).enumerate() {
            let mut values = [0.0; N];
            for (k, (value, b)) in values.iter_mut().zip(group.as_chunks().0).enumerate() {
                *value = f32::from_le_bytes(*b);
                if !value.is_finite() && !self.lenient {
                    let at = At::Byte(offset + 4 * (N * i + k) as u64);
                    return Err(
                        self.problem(at, format!("a value of the {what} is {value}, but must be finite"))
                    );
                }
            }
            all.push(values);
        }
        Ok(all)
    }

    pub fn vec2s(&self, what: &str, offset: u64, count: u64) -> Result<Vec<Vec2>> {
        Ok(self.floats::<2>(what, offset, count)?.into_iter().map(Vec2::from).collect())
    }

    pub fn vec3s(&self, what: &str, offset: u64, count: u64) -> Result<Vec<Vec3>> {
        Ok(self.floats::<3>(what, offset, count)?.into_iter().map(Vec3::from).collect())
    }

    /// Returns the trimmed lines with their numbers, counted from 1. Invalid UTF-8 is an error.
    pub fn lines(&self) -> impl Iterator<Item = Result<(u64, &'a str)>> + '_ {
        self.bytes.split(|b| *b == b'\n').enumerate().map(|(i, line)| {
            let number = i as u64 + 1;
            match std::str::from_utf8(line) {
                Ok(text) => Ok((number, text.trim())),
                Err(_) => Err(self.problem(At::Line(number), "the line is not text (invalid UTF-8)")),
            }
        })
    }

    /// Parses a number of a text file.
    pub fn number(&self, line: u64, word: Option<&str>, what: &str) -> Result<f32> {
        let word = word.ok_or_else(|| self.problem(At::Line(line), format!("{what} is missing")))?;
        match word.parse::<f32>() {
            Ok(value) if value.is_finite() || self.lenient => Ok(value),
            _ => Err(self.problem(
                At::Line(line),
                format!("{what} should be a finite number, but is “{}”", excerpt(word)),
            )),
        }
    }

    /// Parses a count of a text file.
    pub fn count(&self, line: u64, word: Option<&str>, what: &str) -> Result<u64> {
        let word = word.ok_or_else(|| self.problem(At::Line(line), format!("{what} is missing")))?;
        word.parse().map_err(|_| {
            self.problem(At::Line(line), format!("{what} should be a count, but is “{}”", excerpt(word)))
        })
    }

    /// Parses three numbers of a text file.
    pub fn vec3<'w>(&self, line: u64, words: &mut impl Iterator<Item = &'w str>, what: &str) -> Result<Vec3> {
        let mut next = |axis| self.number(line, words.next(), &format!("{what} {axis}"));
        Ok(Vec3::new(next("x")?, next("y")?, next("z")?))
    }
}

/// Returns the beginning of a word, to keep error messages short.
pub(crate) fn excerpt(word: &str) -> String {
    let mut short: String = word.chars().take(24).collect();
    if short.len() < word.len() {
        short.push('…');
    }
    short
}
