//! Imports cooked grooms, which are complete, oriented and repaired.

use super::{FileBytes, Heads, ImportOptions, Moment, SortedFiles};
use crate::{
    CookedGroom,
    error::{At, Error, Result},
    formats::{is_cooked, source::Files},
};
use std::path::{Path, PathBuf};

/// Returns the cooked groom among `paths`, with its path; `None` if there is none.
///
/// # Errors
/// The errors of [`CookedGroom::read`], and [`Error::File`] if other files accompany the cooked groom or the options select
/// a unit, axes or a frame.
pub fn cooked<P: AsRef<Path>, H: AsRef<Path>>(
    paths: &[P],
    heads: &[H],
    options: &ImportOptions,
) -> Result<Option<(PathBuf, CookedGroom)>> {
    let found = find(Files::Disk, paths, &Heads::of(heads), options)?;
    Ok(found.map(|(path, cooked)| (path.to_path_buf(), cooked)))
}

/// [`cooked`] for files in memory, as [`super::read_given`] takes them.
///
/// # Errors
/// See [`cooked`].
pub fn given_cooked(
    files: &[FileBytes<'_>],
    options: &ImportOptions,
) -> Result<Option<(PathBuf, CookedGroom)>> {
    // Sorting the other files may take as long as reading them.
    if !files.iter().any(|(name, _)| is_cooked(name)) {
        return Ok(None);
    }
    let sorted = SortedFiles::new(files)?;
    let found = find(Files::Given(files), &sorted.grooms, &sorted.heads(), options)?;
    Ok(found.map(|(path, cooked)| (path.to_path_buf(), cooked)))
}

pub(super) fn find<'a, P: AsRef<Path>>(
    from: Files<'_>,
    paths: &'a [P],
    heads: &Heads<'_>,
    options: &ImportOptions,
) -> Result<Option<(&'a Path, CookedGroom)>> {
    let Some(path) = paths.iter().map(AsRef::as_ref).find(|path| is_cooked(path)) else { return Ok(None) };
    let wrong =
        |problem: &str| Error::File { path: path.to_path_buf(), at: At::File, problem: problem.into() };
    if paths.len() > 1 || !heads.paths.is_empty() {
        return Err(wrong("a cooked groom includes its head and all its strands; do not add other files"));
    }
    let ImportOptions { orient, orient_head, moment, .. } = options;
    if [orient, orient_head].iter().any(|choice| **choice != Default::default()) {
        return Err(wrong("a cooked groom is in meters and upright; unit and axes cannot be set"));
    }
    if *moment != Moment::First {
        return Err(wrong("a cooked groom is not animated; a frame cannot be selected"));
    }
    Ok(Some((path, CookedGroom::read(path, &from.load(path)?)?)))
}
