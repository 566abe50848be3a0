//! Sources of files: the disk, or bytes already in memory, as in a browser.

use super::Source;
use crate::{
    error::{At, Error, Result},
    formats,
};
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

/// A file that is there already: its name, whose ending decides the format, and its bytes.
pub type Given<'a> = (PathBuf, Cow<'a, [u8]>);

/// A source of files.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Files<'a> {
    /// The system's.
    Disk,
    /// These and no others.
    Given(&'a [Given<'a>]),
}

impl<'a> Files<'a> {
    /// A whole file, or the error that names it.
    pub fn load(self, path: &Path) -> Result<Cow<'a, [u8]>> {
        match self {
            Self::Disk => super::load(path).map(Cow::Owned),
            Self::Given(all) => {
                // What is dropped or picked has lost its folder.
                let found = all.iter().find(|(name, _)| name == path);
                let found =
                    found.or_else(|| all.iter().find(|(name, _)| name.file_name() == path.file_name()));
                let missing = || Error::Io {
                    path: path.to_path_buf(),
                    source: std::io::Error::new(std::io::ErrorKind::NotFound, "it was not given"),
                };
                found.map(|(_, bytes)| Cow::Borrowed(&**bytes)).ok_or_else(missing)
            }
        }
    }
}

/// The folders and bytes that a reader looks for a file's companions in.
impl<'a> Source<'a> {
    /// The file `name` that this one needs.
    pub fn companion(&self, name: &str) -> Result<Cow<'a, [u8]>> {
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        self.files.load(&path).map_err(|error| match self.files {
            Files::Disk => error,
            Files::Given(_) => {
                self.problem(At::File, format!("it needs {name}, which has to be given with it"))
            }
        })
    }
}

/// What a file is, as its name and its first lines have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Strands: `.tfx`, `.hair`, `.data`, `.ply`, or `.obj`, `.glb`, `.abc`, `.usd` and the like with lines, curves or hair.
    Groom,
    /// A mesh: `.tfxmesh`, or `.obj`, `.glb`, `.abc`, `.usd` and the like without.
    Mesh,
    /// What a mesh may need beside it: `.mtl`, `.bin`, pictures.
    Companion,
}

/// Whether a glTF file has hair. The names of extensions and lists stand in it as they are.
fn has_hair(bytes: &[u8]) -> bool {
    holds(bytes, b"EXT_tresses_hair")
}

/// Whether the groom called `name` holds a body too, which is its head where no other is given: a glTF file may hold both,
/// and a USD file whose hair and body are on a skeleton, or that we wrote.
pub fn holds_body(name: &Path, bytes: &[u8]) -> bool {
    #[cfg(feature = "usd")]
    if formats::extension(name).starts_with("usd") {
        return super::usd::holds_body(name, bytes);
    }
    formats::is_gltf(name) && has_hair(bytes) && holds(bytes, b"\"meshes\"")
}

fn holds(bytes: &[u8], word: &[u8]) -> bool {
    bytes.windows(word.len()).any(|window| window == word)
}

/// What the file called `name` is, or `None` for one that no reader takes.
pub fn kind(name: &Path, bytes: &[u8]) -> Option<Kind> {
    let extension = formats::extension(name);
    let is = |all: &[&str]| all.contains(&extension.as_str());
    match (is(formats::GROOMS), is(formats::MESHES)) {
        (true, true) if extension == "abc" => {
            // The names of schemas are shared texts, so they stand in the file as they are.
            let curves = bytes.windows(14).any(|window| window == b"AbcGeom_Curve_");
            Some(if curves { Kind::Groom } else { Kind::Mesh })
        }
        #[cfg(feature = "usd")]
        (true, true) if extension.starts_with("usd") => {
            Some(if super::usd::holds_curves(name, bytes) { Kind::Groom } else { Kind::Mesh })
        }
        (true, true) if formats::is_gltf(name) => {
            Some(if has_hair(bytes) { Kind::Groom } else { Kind::Mesh })
        }
        (true, true) => {
            let mut elements = bytes.split(|b| *b == b'\n').filter_map(|line| {
                let line = line.trim_ascii_start();
                let next = line.get(1).is_some_and(u8::is_ascii_whitespace);
                line.first().copied().filter(|first| next && matches!(first, b'l' | b'f'))
            });
            // One with neither is left to the reader of grooms, who says what is missing.
            Some(if elements.next() == Some(b'f') { Kind::Mesh } else { Kind::Groom })
        }
        (true, false) => Some(Kind::Groom),
        (false, true) => Some(Kind::Mesh),
        (false, false) => is(formats::COMPANIONS).then_some(Kind::Companion),
    }
}
