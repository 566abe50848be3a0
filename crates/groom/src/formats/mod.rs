//! The table of file formats. Readers, writers, dialogs, help texts and the documentation follow it.
//!
//! A new format is a module in this folder and a row of [`FORMATS`]. The module provides functions of these types:
//!
//! - `fn(&Source, Moment) -> Result<Raw>` reads strands, `fn(&Source) -> Result<RawMesh>` a mesh, both in the file's
//!   unit and axes;
//! - `fn(&Path, &[u8]) -> bool`, if a file may hold strands or a mesh, returns whether it holds strands;
//! - the functions of a [`Writer`] encode strands and, if the format supports them, characters, meshes and caches.

#[cfg(feature = "alembic")]
mod abc;
mod chain;
mod content;
#[cfg(any(feature = "alembic", feature = "usd"))]
mod curves;
mod data;
pub(crate) mod faces;
#[cfg(feature = "gltf")]
pub(crate) mod gltf;
mod hair;
#[cfg(feature = "npz")]
mod npz;
mod obj;
pub(crate) mod parse;
mod ply;
pub(crate) mod raw;
pub(crate) mod source;
mod tfx;
mod tfxmesh;
mod usd;
pub(crate) mod writer;

pub use content::ContentKind;

use crate::{
    Result,
    error::{At, Error},
};
use raw::{Moment, Raw, RawMesh};
use source::Source;
use std::path::Path;
use writer::Writer;

/// A file format.
#[derive(Clone, Copy, Debug)]
pub struct FileFormat {
    /// Display name.
    pub name: &'static str,
    /// Lowercase file extensions, the usual one first.
    pub extensions: &'static [&'static str],
    /// Feature of this crate that enables the reader; `None` if the reader is always enabled.
    pub feature: Option<&'static str>,
    /// Whether the web page reads the format.
    pub in_browsers: bool,
    /// Contents that the readers return.
    pub reads: &'static [ContentKind],
    /// Writers, one per extension.
    pub writers: &'static [Writer],
    /// Extensions of files that a mesh may refer to: materials, buffers, textures.
    pub resources: &'static [&'static str],
    /// Reads strands at one moment. `None` if the feature is off or the format has no strands.
    pub(crate) read: Option<fn(&Source<'_>, Moment) -> Result<Raw>>,
    /// Reads a mesh. `None` if the feature is off or the format has no meshes.
    pub(crate) read_mesh: Option<fn(&Source<'_>) -> Result<RawMesh>>,
    /// Returns whether a file has strands, for formats whose files may also be only a mesh.
    pub(crate) is_groom: Option<fn(&Path, &[u8]) -> bool>,
    /// Returns whether a file with strands also has the mesh that they grow on.
    pub(crate) holds_body: Option<fn(&Path, &[u8]) -> bool>,
    /// Kind of a file that holds a complete groom, instead of `read` and `read_mesh`.
    pub(crate) complete: Option<CompleteGroom>,
}

/// A file with a groom that is complete: guides, strands and head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CompleteGroom {
    /// [`CookedGroom`](crate::cooked::CookedGroom).
    Cooked,
    /// [`GroomDocument`](crate::edit::GroomDocument).
    Edited,
}

/// Default values for rows.
const NONE: FileFormat = FileFormat {
    name: "",
    extensions: &[],
    feature: None,
    in_browsers: true,
    reads: &[],
    writers: &[],
    resources: &[],
    read: None,
    read_mesh: None,
    is_groom: None,
    holds_body: None,
    complete: None,
};

/// Expands to `Some` of the value if the feature is on, else to `None`.
macro_rules! with {
    ($feature:literal, $value:expr) => {{
        #[cfg(feature = $feature)]
        {
            Some($value)
        }
        #[cfg(not(feature = $feature))]
        {
            None
        }
    }};
}

use ContentKind::*;

/// All formats, in display order.
pub const FORMATS: &[FileFormat] = &[
    FileFormat {
        name: "TressFX",
        extensions: &["tfx"],
        reads: &[Strands, Colors, RootUvs, PinnedTips, Followers, Units],
        read: Some(|source, _| tfx::read(source)),
        writers: &[Writer::new("tfx", &[Strands, Colors, RootUvs, PinnedTips, Units], tfx::encode)],
        ..NONE
    },
    FileFormat {
        name: "Cem Yuksel's hair files",
        extensions: &["hair"],
        reads: &[Strands, Widths, Colors, Units],
        read: Some(|source, _| hair::read(source)),
        writers: &[Writer::new("hair", &[Strands, Widths, Colors, Units], hair::encode)],
        ..NONE
    },
    FileFormat {
        name: "Wavefront OBJ",
        extensions: &["obj"],
        reads: &[Strands, Units, Mesh],
        read: Some(|source, _| obj::read(source)),
        read_mesh: Some(obj::read_mesh),
        is_groom: Some(obj::is_groom),
        resources: &["mtl"],
        writers: &[Writer {
            mesh: Some(obj::encode_mesh),
            ..Writer::new("obj", &[Strands, Units, Mesh], obj::encode)
        }],
        ..NONE
    },
    FileFormat {
        name: "USC-HairSalon strands",
        extensions: &["data"],
        reads: &[Strands],
        read: Some(|source, _| data::read(source)),
        writers: &[Writer::new("data", &[Strands], data::encode)],
        ..NONE
    },
    FileFormat {
        name: "NumPy arrays, DiffLocks",
        extensions: &["npz"],
        feature: Some("npz"),
        in_browsers: false,
        reads: &[Strands, Widths, Colors, RootUvs, Look, Units],
        read: with!("npz", |source, _| npz::read(source)),
        ..NONE
    },
    FileFormat {
        name: "PLY line sets",
        extensions: &["ply"],
        reads: &[Strands, Widths, Units],
        read: Some(|source, _| ply::read(source)),
        writers: &[Writer::new("ply", &[Strands, Widths, Units], ply::encode)],
        ..NONE
    },
    FileFormat {
        name: "glTF with EXT_tresses_hair",
        extensions: &["glb", "gltf"],
        feature: Some("gltf"),
        reads: &[
            Strands, Widths, Colors, RootUvs, PinnedTips, Guides, Attributes, Look, Units, Mesh, Textures,
            Rig, Animations, Lights,
        ],
        read: with!("gltf", |source, _| gltf::read(source)),
        read_mesh: with!("gltf", gltf::read_mesh),
        is_groom: with!("gltf", gltf::is_groom),
        holds_body: with!("gltf", gltf::holds_body),
        resources: &["bin", "png", "jpg", "jpeg"],
        writers: &[
            #[cfg(feature = "gltf")]
            Writer {
                compresses: true,
                character: Some(gltf::character),
                mesh: Some(gltf::body),
                ..Writer::new(
                    "glb",
                    &[
                        Strands, Widths, Colors, RootUvs, PinnedTips, Guides, Attributes, Look, Units, Mesh,
                        Rig, Animations,
                    ],
                    gltf::encode,
                )
            },
        ],
        ..NONE
    },
    FileFormat {
        name: "Alembic (Ogawa)",
        extensions: &["abc"],
        feature: Some("alembic"),
        reads: &[Strands, Widths, Colors, RootUvs, Guides, Attributes, Units, Frames, Mesh],
        read: with!("alembic", abc::read),
        read_mesh: with!("alembic", abc::read_mesh),
        is_groom: with!("alembic", abc::is_groom),
        writers: &[
            #[cfg(feature = "alembic")]
            Writer {
                any_unit: true,
                cache: Some(abc::cache),
                ..Writer::new(
                    "abc",
                    &[Strands, Widths, Colors, RootUvs, Guides, Attributes, Units, Frames],
                    abc::encode,
                )
            },
        ],
        ..NONE
    },
    FileFormat {
        name: "USD",
        extensions: &["usd", "usda", "usdc", "usdz"],
        feature: Some("usd"),
        in_browsers: false,
        reads: &[Strands, Widths, Colors, RootUvs, Guides, Attributes, Units, Frames, Mesh, Rig, Animations],
        read: with!("usd", usd::read),
        read_mesh: with!("usd", usd::read_mesh),
        is_groom: with!("usd", usd::is_groom),
        holds_body: with!("usd", usd::holds_body),
        writers: &[
            Writer {
                any_unit: true,
                character: Some(usd::character),
                mesh: Some(usd::body),
                cache: Some(usd::cache),
                ..Writer::new(
                    "usda",
                    &[
                        Strands, Widths, Colors, RootUvs, Guides, Attributes, Units, Frames, Mesh, Rig,
                        Animations,
                    ],
                    usd::encode,
                )
            },
            #[cfg(feature = "usd")]
            Writer {
                any_unit: true,
                character: Some(usd::packed::character),
                mesh: Some(usd::packed::body),
                ..Writer::new(
                    "usdc",
                    &[Strands, Widths, Colors, RootUvs, Guides, Attributes, Units, Mesh, Rig, Animations],
                    usd::packed::encode,
                )
            },
        ],
        ..NONE
    },
    FileFormat {
        name: "cooked groom, for one version of Tresses",
        extensions: &["tresses"],
        feature: Some("cooked"),
        reads: &[
            Strands, Widths, Colors, RootUvs, PinnedTips, Guides, Attributes, Followers, Look, Units, Mesh,
            Textures, Rig, Animations, Lights, Computed,
        ],
        read: with!("cooked", |source, _| {
            let problem = "a cooked groom is complete and cannot be part of another";
            Err(source.problem(At::File, problem))
        }),
        complete: Some(CompleteGroom::Cooked),
        ..NONE
    },
    FileFormat {
        name: "groom edited in the studio",
        extensions: &["groom"],
        feature: Some("edit"),
        reads: &[Strands, Widths, Colors, PinnedTips, Guides, Units, Mesh, Textures, Rig, Animations, Lights],
        read: with!("edit", |source, _| {
            let problem = "an edited groom is complete and cannot be part of another";
            Err(source.problem(At::File, problem))
        }),
        complete: Some(CompleteGroom::Edited),
        ..NONE
    },
    FileFormat {
        name: "TressFX collision mesh",
        extensions: &["tfxmesh"],
        reads: &[Mesh],
        read_mesh: Some(tfxmesh::read),
        ..NONE
    },
];

/// Extensions of files that can hold a groom. An `.obj` is a groom if its first element is a line, a `.glb` or `.gltf`
/// if it has `EXT_tresses_hair`.
pub const GROOMS: &[&str] = &joined::<{ count(List::Grooms) }>(List::Grooms);
/// Extensions of files that can hold a mesh. An `.obj` is a mesh if its first element is a face, an `.abc` or `.usd` if
/// it has no curves.
pub const MESHES: &[&str] = &joined::<{ count(List::Meshes) }>(List::Meshes);
/// Extensions of grooms that can be written.
pub const WRITTEN: &[&str] = &joined::<{ count(List::Written) }>(List::Written);
/// Extensions of files that a mesh may refer to.
pub const RESOURCES: &[&str] = &joined::<{ count(List::Resources) }>(List::Resources);

#[derive(Clone, Copy)]
enum List {
    Grooms,
    Meshes,
    Written,
    Resources,
}

/// Returns the `k`-th extension that `format` adds to `list`.
const fn entry(format: &FileFormat, list: List, k: usize) -> Option<&'static str> {
    let all = match list {
        List::Grooms if format.read.is_some() => format.extensions,
        List::Meshes if format.read_mesh.is_some() => format.extensions,
        List::Resources if format.read_mesh.is_some() => format.resources,
        List::Written if k < format.writers.len() => return Some(format.writers[k].extension),
        _ => &[],
    };
    if k < all.len() { Some(all[k]) } else { None }
}

const fn count(list: List) -> usize {
    let (mut all, mut i) = (0, 0);
    while i < FORMATS.len() {
        let mut k = 0;
        while entry(&FORMATS[i], list, k).is_some() {
            k += 1;
        }
        (all, i) = (all + k, i + 1);
    }
    all
}

/// Collects the [`count`] extensions of a list.
const fn joined<const N: usize>(list: List) -> [&'static str; N] {
    let (mut all, mut n, mut i) = ([""; N], 0, 0);
    while i < FORMATS.len() {
        let mut k = 0;
        while let Some(extension) = entry(&FORMATS[i], list, k) {
            all[n] = extension;
            (n, k) = (n + 1, k + 1);
        }
        i += 1;
    }
    all
}

impl FileFormat {
    /// Returns the format of `path`, by its extension.
    pub fn of(path: &Path) -> Option<&'static Self> {
        let extension = extension(path);
        FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
    }

    /// Returns the error for a file that no reader accepts as `what` (“a groom”), which has one of `extensions`.
    pub(crate) fn unread(path: &Path, what: &str, extensions: &[&str]) -> Error {
        let missing = Self::of(path).filter(|format| format.read.is_none() && format.read_mesh.is_none());
        let problem = match missing.and_then(|format| Some((format.name, format.feature?))) {
            Some((name, feature)) => {
                format!("reading {name} needs the feature `{feature}`, which is off")
            }
            None => format!("{what} is a {} file", listed(extensions, "or")),
        };
        Error::File { path: path.to_path_buf(), at: At::File, problem }
    }
}

/// Returns the extensions of writers that can hold `content`.
pub fn written(content: ContentKind) -> Vec<&'static str> {
    let writers = FORMATS.iter().flat_map(|format| format.writers);
    writers.filter(|writer| writer.holds.contains(&content)).map(|writer| writer.extension).collect()
}

/// Returns the lowercase extension of `path`, or an empty string.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Returns whether `path` has the extension of a cooked groom.
pub fn is_cooked(path: &Path) -> bool {
    FileFormat::of(path).is_some_and(|format| format.complete == Some(CompleteGroom::Cooked))
}

/// Returns whether `path` has the extension of a groom with its head, in meters and upright: a cooked or edited one.
pub fn is_complete_groom(path: &Path) -> bool {
    FileFormat::of(path).is_some_and(|format| format.complete.is_some())
}

/// Joins extensions for a sentence, with `joint` before the last: ".tfx, .hair or .obj".
pub fn listed(extensions: &[&str], joint: &str) -> String {
    let dotted: Vec<_> = extensions.iter().map(|extension| format!(".{extension}")).collect();
    match dotted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} {joint} {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Returns the table as Markdown, for the documentation.
pub fn markdown() -> String {
    let names = |contents: &[ContentKind]| contents.iter().map(|it| it.name()).collect::<Vec<_>>().join(", ");
    let files = |all: &[&str]| all.iter().map(|it| format!("`.{it}`")).collect::<Vec<_>>().join(", ");
    let mut text =
        String::from("| files | format | reads | writes | read by the web page |\n|---|---|---|---|---|\n");
    for format in FORMATS {
        let written = |writer: &Writer| {
            let lost = format.reads.iter().copied().filter(|it| !writer.holds.contains(it));
            match names(&lost.collect::<Vec<_>>()) {
                lost if lost.is_empty() => format!("`.{}`", writer.extension),
                lost => format!("`.{}` without {lost}", writer.extension),
            }
        };
        let mut written: Vec<String> = format.writers.iter().map(written).collect();
        match format.complete {
            Some(CompleteGroom::Cooked) => written.push("by `tresses convert`".into()),
            Some(CompleteGroom::Edited) => written.push("by the studio and `tresses groom`".into()),
            None => {}
        }
        text += &format!(
            "| {} | {} | {} | {} | {} |\n",
            files(format.extensions),
            format.name,
            names(format.reads),
            if written.is_empty() { "no".into() } else { written.join("; ") },
            if format.in_browsers { "yes" } else { "no" },
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn listed_joins_extensions() {
        assert_eq!(listed(&["tfx", "hair", "obj"], "or"), ".tfx, .hair or .obj");
        assert_eq!(listed(&["png"], "or"), ".png");
        assert_eq!(extension(Path::new("a/B.GLTF")), "gltf");
    }

    #[test]
    fn row_fields_match_functions() {
        let mut seen: Vec<&str> = Vec::new();
        for format in FORMATS {
            let (name, reads) = (format.name, |content| format.reads.contains(&content));
            let on = match format.feature {
                Some("gltf") => cfg!(feature = "gltf"),
                Some("alembic") => cfg!(feature = "alembic"),
                Some("usd") => cfg!(feature = "usd"),
                Some("cooked") => cfg!(feature = "cooked"),
                Some("edit") => cfg!(feature = "edit"),
                Some("npz") => cfg!(feature = "npz"),
                Some(other) => panic!("{name}: no feature {other}"),
                None => true,
            };
            let has_mesh = reads(Mesh) && format.complete.is_none();
            assert_eq!(format.read.is_some(), on && reads(Strands), "{name}");
            assert_eq!(format.read_mesh.is_some(), on && has_mesh, "{name}");
            assert_eq!(format.is_groom.is_some(), on && reads(Strands) && has_mesh, "{name}");
            for writer in format.writers {
                let holds = |content| writer.holds.contains(&content);
                assert!(format.extensions.contains(&writer.extension) && holds(Strands), "{name}");
                assert_eq!((holds(Mesh), holds(Frames)), (writer.mesh.is_some(), writer.cache.is_some()));
                assert_eq!(holds(Rig), writer.character.is_some(), "{name}");
            }
            seen.extend(format.extensions);
        }
        let count = seen.len();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), count, "an extension is that of one format: {seen:?}");
    }
}
