//! Imports edited grooms, which are complete, oriented and repaired; and the files of a head, to store them with one.

use super::{
    Attributes, FileBytes, FileReport, Heads, ImportOptions, ImportReport, ImportedBody, SortedFiles,
};
use crate::{
    Strands, TriMesh,
    bound::StrandBinding,
    edit::{GroomDocument, HeadFiles, file::EXTENSION},
    error::Result,
    formats::{
        extension,
        source::{Files, RecordedFiles},
    },
    lint, mannequin,
    orient::{OrientationOverride, Placement},
    strands::Mark,
};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

/// Returns the edited groom among `paths`, with its path; `None` if there is none.
///
/// # Errors
/// The errors of [`GroomDocument::read`], and [`Error::File`](crate::Error::File) if other files accompany the edited
/// groom or the options select a unit, axes or a frame.
pub fn edited<P: AsRef<Path>, H: AsRef<Path>>(
    paths: &[P],
    heads: &[H],
    options: &ImportOptions,
) -> Result<Option<(PathBuf, GroomDocument)>> {
    let found = find(Files::Disk, paths, &Heads::of(heads), options)?;
    Ok(found.map(|(path, document)| (path.to_path_buf(), document)))
}

/// [`edited`] for files in memory, as [`super::read_given`] takes them.
///
/// # Errors
/// See [`edited`].
pub fn given_edited(
    files: &[FileBytes<'_>],
    options: &ImportOptions,
) -> Result<Option<(PathBuf, GroomDocument)>> {
    if !files.iter().any(|(name, _)| is_edited(name)) {
        return Ok(None);
    }
    let sorted = SortedFiles::new(files)?;
    let found = find(Files::Given(files), &sorted.grooms, &sorted.heads(), options)?;
    Ok(found.map(|(path, document)| (path.to_path_buf(), document)))
}

fn is_edited(path: &Path) -> bool {
    extension(path) == EXTENSION
}

pub(super) fn find<'a, P: AsRef<Path>>(
    from: Files<'_>,
    paths: &'a [P],
    heads: &Heads<'_>,
    options: &ImportOptions,
) -> Result<Option<(&'a Path, GroomDocument)>> {
    let Some(path) = paths.iter().map(AsRef::as_ref).find(|path| is_edited(path)) else { return Ok(None) };
    super::check_single(path, paths.len(), heads, options)?;
    Ok(Some((path, GroomDocument::read(path, &from.load(path)?)?)))
}

/// Returns the strands, the head and the import report of an edited groom. `path` names it.
///
/// # Errors
/// The errors of [`super::read_body`].
pub fn edited_complete(
    path: &Path,
    document: &GroomDocument,
) -> Result<(Strands, Option<TriMesh>, ImportReport)> {
    let mut strands = document.groom().strands.unbound();
    strands.tip_pinned = pinned(document);
    strands.marks = marks(document);
    let body = edited_body(document)?;
    let file = FileReport {
        path: path.to_path_buf(),
        format: "edited groom",
        strands: strands.len(),
        vertices: strands.positions.len(),
        notes: Vec::new(),
    };
    let (head, rig, lights, head_placement) = match body {
        Some(body) => (Some(body.mesh), body.rig, body.lights, Some(body.placement)),
        None => (None, None, Vec::new(), None),
    };
    let report = ImportReport {
        files: vec![file],
        placement: Placement::default(),
        head_placement,
        rig,
        lights,
        lint: lint::check(&strands, head.as_ref()),
        repaired: lint::RepairReport::default(),
        followers: Vec::new(),
        groups: super::groups(&strands, &BTreeMap::new()),
        attributes: Attributes::of(&strands),
        look: None,
    };
    Ok((strands, head, report))
}

/// Returns the group of each strand, which is the group of its first guide; empty without groups.
fn marks(document: &GroomDocument) -> Vec<Mark> {
    let base = document.base();
    let group = |guides: [u32; 3]| base.guides.groups.get(guides[0] as usize).copied();
    let mark = |(id, binding): (i32, &StrandBinding)| {
        Some(Mark { id, group: group(binding.guides)?, closest: [-1; 3], ..Mark::default() })
    };
    (0..).zip(&base.strands.bindings).filter_map(mark).collect()
}

/// Returns whether the tip of each strand is fixed: that of its first guide is; empty if none is.
fn pinned(document: &GroomDocument) -> Vec<bool> {
    let base = document.base();
    let of = |guides: [u32; 3]| base.guides.tip_pinned[guides[0] as usize];
    let pinned: Vec<bool> = base.strands.bindings.iter().map(|binding| of(binding.guides)).collect();
    if pinned.contains(&true) { pinned } else { Vec::new() }
}

/// Returns the head of an edited groom; `None` if it has none.
///
/// # Errors
/// The errors of [`super::read_body`].
pub fn edited_body(document: &GroomDocument) -> Result<Option<ImportedBody>> {
    let (files, orientation) = match document.head() {
        HeadFiles::None => return Ok(None),
        HeadFiles::BuiltIn => {
            let mesh = mannequin::mesh(mannequin::RESOLUTION);
            return Ok(Some(ImportedBody {
                mesh,
                rig: None,
                lights: Vec::new(),
                placement: Placement::default(),
            }));
        }
        HeadFiles::Files { files, orientation } => (files, orientation),
    };
    #[cfg(feature = "cooked")]
    if let [(path, bytes)] = &files[..]
        && crate::formats::is_cooked(path)
    {
        let cooked = crate::CookedGroom::read(path, bytes)?;
        let (placement, lights) = (Placement::default(), cooked.report(path).lights);
        return Ok(cooked.head.map(|mesh| ImportedBody { mesh, rig: cooked.rig, lights, placement }));
    }
    let files: Vec<FileBytes<'_>> =
        files.iter().map(|(name, bytes)| (name.clone(), Cow::Borrowed(&**bytes))).collect();
    let options = ImportOptions { orient_head: *orientation, ..ImportOptions::default() };
    let sorted = SortedFiles::new(&files)?;
    super::body_of(Files::Given(&files), &sorted.heads().paths, &options).map(Some)
}

/// Returns the files of a head: `heads` or, without any, the files of `grooms` with a body, and the files that they
/// refer to. `placement` is how the import has placed the head.
///
/// # Errors
/// The errors of [`super::read_complete`].
pub fn head_files<P: AsRef<Path>, H: AsRef<Path>>(
    grooms: &[P],
    heads: &[H],
    placement: &Placement,
) -> Result<HeadFiles> {
    let mut paths: Vec<&Path> = heads.iter().map(AsRef::as_ref).collect();
    if paths.is_empty() {
        paths = grooms.iter().map(AsRef::as_ref).collect();
    }
    recorded(Files::Disk, &paths, placement)
}

/// [`head_files`] for files in memory.
///
/// # Errors
/// See [`head_files`].
pub fn given_head_files(files: &[FileBytes<'_>], placement: &Placement) -> Result<HeadFiles> {
    let sorted = SortedFiles::new(files)?;
    let heads = sorted.heads().paths;
    recorded(Files::Given(files), if heads.is_empty() { &sorted.grooms } else { &heads }, placement)
}

fn recorded(from: Files<'_>, paths: &[&Path], placement: &Placement) -> Result<HeadFiles> {
    let recorder = RecordedFiles { from, read: Mutex::default() };
    let files = Files::Recorded(&recorder);
    match paths {
        [path] if crate::formats::is_cooked(path) => files.load(path).map(|_| ())?,
        _ => super::mesh::read_from(files, paths).map(|_| ())?,
    }
    // Files that others refer to are found by name alone.
    let read = recorder.read.into_inner().unwrap_or_else(PoisonError::into_inner);
    let name = |path: PathBuf| path.file_name().map(PathBuf::from).unwrap_or(path);
    let files: Vec<(PathBuf, Arc<[u8]>)> =
        read.into_iter().map(|(path, bytes)| (name(path), bytes)).collect();
    let Placement { unit, up, front, mirrored, .. } = placement;
    let orientation = OrientationOverride {
        unit: Some(*unit),
        up: Some(*up),
        front: Some(*front),
        is_mirrored: Some(*mirrored),
    };
    Ok(HeadFiles::Files { files, orientation })
}
