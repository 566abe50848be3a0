//! Files by name: bytes already in memory, as in a browser, and the disk where there is one.

use anyhow::{Context, Result, ensure};
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::Arc,
};
use tresses::groom::import::Given;

/// A file that is there already.
pub type Held = (PathBuf, Arc<[u8]>);

/// Files that are there as bytes; others are looked for on the disk.
#[derive(Clone, Debug, Default)]
pub struct Shelf(Vec<Held>);

impl PartialEq for Shelf {
    /// The same bytes in memory: they may be large.
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&Held, &Held)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1);
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(same)
    }
}

impl Shelf {
    /// Puts a file on it, in the place of another of that name.
    pub fn put(&mut self, name: PathBuf, bytes: impl Into<Arc<[u8]>>) {
        self.0.retain(|(held, _)| *held != name);
        self.0.push((name, bytes.into()));
    }

    /// Takes a file off it.
    pub fn take(&mut self, name: &Path) {
        self.0.retain(|(held, _)| held != name);
    }

    /// Everything of `other` too.
    pub fn add(&mut self, other: &Self) {
        for (name, bytes) in &other.0 {
            self.put(name.clone(), bytes.clone());
        }
    }

    /// Whether the file at `path` is there as bytes.
    pub fn holds(&self, path: &Path) -> bool {
        self.find(path).is_some()
    }

    /// The files as readers take them.
    pub fn given(&self) -> Vec<Given<'_>> {
        self.0.iter().map(|(name, bytes)| (name.clone(), Cow::Borrowed(&**bytes))).collect()
    }

    /// A whole file. What was dropped or picked has lost its folder: its name alone is looked for too.
    ///
    /// # Errors
    /// One sentence that names the file, when it is nowhere.
    pub fn load(&self, path: &Path) -> Result<Cow<'_, [u8]>> {
        if let Some(bytes) = self.find(path) {
            return Ok(Cow::Borrowed(bytes));
        }
        let name = || path.display().to_string();
        ensure!(
            !cfg!(target_arch = "wasm32"),
            "{} has to be given: choose it, or drop it on the page",
            name()
        );
        std::fs::read(path).map(Cow::Owned).with_context(name)
    }

    fn find(&self, path: &Path) -> Option<&[u8]> {
        let whole = self.0.iter().find(|(name, _)| name == path);
        let found = whole.or_else(|| self.0.iter().find(|(name, _)| name.file_name() == path.file_name()));
        found.map(|(_, bytes)| &**bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_before_the_disk() {
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
