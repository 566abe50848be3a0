//! Imports cooked grooms, which are complete, oriented and repaired.

use super::{FileBytes, Heads, ImportOptions, SortedFiles, check_single};
use crate::{
    CookedGroom,
    error::Result,
    formats::{is_cooked, source::Files},
};
use std::path::{Path, PathBuf};

/// Returns the cooked groom among `paths`, with its path; `None` if there is none.
///
/// # Errors
/// The errors of [`CookedGroom::read`], and [`Error::File`](crate::Error::File) if other files accompany the cooked
/// groom or the options select a unit, axes or a frame.
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
    check_single(path, paths.len(), heads, options)?;
    Ok(Some((path, CookedGroom::read(path, &from.load(path)?)?)))
}
