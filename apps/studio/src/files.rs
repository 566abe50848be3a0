//! Chosen or dropped files: paths on a desktop, bytes in a browser.

use std::{path::PathBuf, sync::Arc};
use tresses::CharacterFiles;
use tresses::groom::import::{self, FileBytes, FileKind};

/// The files of a groom and its head.
#[derive(Clone, Debug)]
pub enum Files {
    /// Paths on disk.
    Disk {
        /// Groom files.
        grooms: Vec<PathBuf>,
        /// Head meshes; may be empty.
        heads: Vec<PathBuf>,
    },
    /// Names and bytes in memory.
    Given(Arc<Vec<FileBytes<'static>>>),
}

impl PartialEq for Files {
    /// Compares paths, or the identity of the bytes in memory.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Disk { grooms: a, heads: b }, Self::Disk { grooms: c, heads: d }) => a == c && b == d,
            (Self::Given(a), Self::Given(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl Files {
    /// Returns the files in the form that the importer takes.
    pub fn borrowed(&self) -> CharacterFiles<'_> {
        match self {
            Self::Disk { grooms, heads } => CharacterFiles::Disk { grooms, heads },
            Self::Given(files) => CharacterFiles::Given(files),
        }
    }

    /// Whether there is a groom among the files, or one of unknown kind, which the groom reader reports.
    pub fn hold_groom(&self) -> bool {
        match self {
            Self::Disk { grooms, .. } => !grooms.is_empty(),
            Self::Given(files) => {
                let kinds = || files.iter().map(|(name, bytes)| import::kind(name, bytes));
                kinds().any(|kind| matches!(kind, None | Some(FileKind::Groom)))
                    || !kinds().any(|kind| kind == Some(FileKind::Mesh))
            }
        }
    }

    /// Returns a short name for titles.
    pub fn name(&self) -> String {
        let paths: Vec<&PathBuf> = match self {
            Self::Disk { grooms, heads } if grooms.is_empty() => heads.iter().collect(),
            Self::Disk { grooms, .. } => grooms.iter().collect(),
            Self::Given(files) => files.iter().map(|(path, _)| path).collect(),
        };
        let name = |path: &&PathBuf| path.file_name().map(|n| n.to_string_lossy().into_owned());
        let first = paths.first().and_then(name).unwrap_or_default();
        if paths.len() > 1 { format!("{first} and {} more", paths.len() - 1) } else { first }
    }
}
