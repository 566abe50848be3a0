//! Writes the Ogawa container in order: leaves first, each group after its children, the root's offset last.

use std::collections::HashMap;
use std::io::{Result, Seek, SeekFrom, Write};

use super::digest::digest;

/// Top bit of an offset: marks data.
const DATA: u64 = 1 << 63;

/// A file being written.
pub(super) struct Ogawa<W> {
    out: W,
    /// Offset of the next byte.
    next: u64,
    /// Offsets of the samples written so far, by digest and length.
    known: HashMap<([u8; 16], usize), u64>,
    /// Strings that many objects and properties share.
    shared: Vec<String>,
}

/// Offset of a group or of data, as its parent stores it.
pub(super) type NodeOffset = u64;

impl<W: Write + Seek> Ogawa<W> {
    pub fn new(mut out: W) -> Result<Self> {
        // The flag for a complete file and the root's offset stay 0 until `finish`.
        out.write_all(b"Ogawa\0\0\x01\0\0\0\0\0\0\0\0")?;
        Ok(Self { out, next: 16, known: HashMap::new(), shared: Vec::new() })
    }

    fn put(&mut self, bytes: &[u8]) -> Result<()> {
        self.out.write_all(bytes)?;
        self.next += bytes.len() as u64;
        Ok(())
    }

    /// Writes a leaf.
    pub fn data(&mut self, bytes: &[u8]) -> Result<NodeOffset> {
        if bytes.is_empty() {
            return Ok(DATA);
        }
        let offset = self.next | DATA;
        self.put(&(bytes.len() as u64).to_le_bytes())?;
        self.put(bytes)?;
        Ok(offset)
    }

    /// Writes a leaf with the digest of its numbers, which have `size` bytes each. Reuses an equal leaf that is already
    /// written.
    pub fn sample(&mut self, bytes: &[u8], size: u32) -> Result<NodeOffset> {
        let digest = digest(bytes, size);
        if let Some(offset) = self.known.get(&(digest, bytes.len())) {
            return Ok(*offset);
        }
        let offset = self.next | DATA;
        self.put(&(16 + bytes.len() as u64).to_le_bytes())?;
        self.put(&digest)?;
        self.put(bytes)?;
        self.known.insert((digest, bytes.len()), offset);
        Ok(offset)
    }

    pub fn group(&mut self, children: &[NodeOffset]) -> Result<NodeOffset> {
        if children.is_empty() {
            return Ok(0);
        }
        let offset = self.next;
        self.put(&(children.len() as u64).to_le_bytes())?;
        for child in children {
            self.put(&child.to_le_bytes())?;
        }
        Ok(offset)
    }

    /// Returns the index of a shared string; `None` if the string must be stored where it is used.
    pub fn shared_index(&mut self, text: &str) -> Option<u8> {
        if text.is_empty() {
            return Some(0);
        }
        let known = self.shared.iter().position(|known| known == text);
        let index = match known {
            Some(index) => index,
            None if text.len() < 256 && self.shared.len() < 254 => {
                self.shared.push(text.to_owned());
                self.shared.len() - 1
            }
            None => return None,
        };
        u8::try_from(index + 1).ok()
    }

    /// Encodes all shared strings, each after its length.
    pub fn shared(&self) -> Vec<u8> {
        self.shared.iter().flat_map(|text| std::iter::once(text.len() as u8).chain(text.bytes())).collect()
    }

    /// Ends the file.
    pub fn finish(mut self, root: NodeOffset) -> Result<W> {
        self.out.seek(SeekFrom::Start(8))?;
        self.out.write_all(&root.to_le_bytes())?;
        self.out.seek(SeekFrom::Start(5))?;
        self.out.write_all(&[0xff])?;
        self.out.seek(SeekFrom::End(0))?;
        self.out.flush()?;
        Ok(self.out)
    }
}
