//! Files by name: bytes in memory, as in a browser, and files on disk where there are any.

use anyhow::{Context, Result, ensure};
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::Arc,
};
use tresses::groom::import::FileBytes;

/// A file in memory.
pub type ShelfItem = (PathBuf, Arc<[u8]>);

/// Files in memory. Files that are not found there are read from disk.
#[derive(Clone, Debug, Default)]
pub struct Shelf(Vec<ShelfItem>);

impl PartialEq for Shelf {
    /// Compares pointers, not bytes: files may be large.
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&ShelfItem, &ShelfItem)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1);
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(same)
    }
}

impl Shelf {
    /// Adds a file, replacing one with the same name.
    pub fn put(&mut self, name: PathBuf, bytes: impl Into<Arc<[u8]>>) {
        self.0.retain(|(held, _)| *held != name);
        self.0.push((name, bytes.into()));
    }

    /// Removes a file.
    pub fn take(&mut self, name: &Path) {
        self.0.retain(|(held, _)| held != name);
    }

    /// Adds all files of `other`.
    pub fn add(&mut self, other: &Self) {
        for (name, bytes) in &other.0 {
            self.put(name.clone(), bytes.clone());
        }
    }

    /// Returns whether the file at `path` is in memory.
    pub fn holds(&self, path: &Path) -> bool {
        self.find(path).is_some()
    }

    /// Returns the files in the form that importers take.
    pub fn given(&self) -> Vec<FileBytes<'_>> {
        self.0.iter().map(|(name, bytes)| (name.clone(), Cow::Borrowed(&**bytes))).collect()
    }

    /// Loads a whole file. Dropped or picked files have lost their folder, so the file name alone also matches.
    ///
    /// # Errors
    /// Fails if the file is not found. The message names the file.
    pub fn load(&self, path: &Path) -> Result<Cow<'_, [u8]>> {
        if let Some(bytes) = self.find(path) {
            return Ok(Cow::Borrowed(bytes));
        }
        let name = || path.display().to_string();
        ensure!(!cfg!(target_arch = "wasm32"), "{} is missing: choose it, or drop it on the page", name());
        std::fs::read(path).map(Cow::Owned).with_context(name)
    }

    fn find(&self, path: &Path) -> Option<&[u8]> {
        let exact = self.0.iter().find(|(name, _)| name == path);
        let found = exact.or_else(|| self.0.iter().find(|(name, _)| name.file_name() == path.file_name()));
        found.map(|(_, bytes)| &**bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_takes_precedence_over_disk() {
        let mut shelf = Shelf::default();
        let here = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"));
        assert!(shelf.load(here).unwrap().starts_with(b"[package]"));
        shelf.put("Cargo.toml".into(), *b"first");
        shelf.put("Cargo.toml".into(), *b"given");
        assert_eq!(&*shelf.load(here).unwrap(), b"given");
        assert_eq!(shelf.given().len(), 1);
        let error = format!("{:#}", shelf.load(Path::new("maps/nowhere.png")).unwrap_err());
        assert!(error.contains("maps/nowhere.png") && !shelf.holds(Path::new("nowhere.png")), "{error}");
        shelf.take(Path::new("map.png"));
        assert_eq!(shelf.given().len(), 1);
        let mut other = Shelf::default();
        other.add(&shelf);
        assert_eq!(other, shelf);
        other.put("Cargo.toml".into(), *b"given");
        assert_ne!(other, shelf, "other bytes, though they say the same");
    }
}
