//! Cooked grooms among the files of a groom: each is whole, oriented and repaired.

use super::{Given, Heads, ImportOptions, Moment, Sorted};
use crate::{
    Cooked,
    error::{At, Error, Result},
    formats::{is_cooked, source::Files},
};
use std::path::{Path, PathBuf};

/// The cooked groom that these files are, with its path; `None` where none of them is one.
///
/// # Errors
/// As [`Cooked::read`], and [`Error::File`] for one that comes with other files or is to be read otherwise than it is.
pub fn cooked<P: AsRef<Path>, H: AsRef<Path>>(
    paths: &[P],
    heads: &[H],
    options: &ImportOptions,
) -> Result<Option<(PathBuf, Cooked)>> {
    let found = find(Files::Disk, paths, &Heads::of(heads), options)?;
    Ok(found.map(|(path, cooked)| (path.to_path_buf(), cooked)))
}

/// The same from bytes, as [`super::read_given`] takes them.
///
/// # Errors
/// As [`cooked`].
pub fn given_cooked(files: &[Given<'_>], options: &ImportOptions) -> Result<Option<(PathBuf, Cooked)>> {
    // To tell what the others are may take as long as to read them.
    if !files.iter().any(|(name, _)| is_cooked(name)) {
        return Ok(None);
    }
    let sorted = Sorted::new(files)?;
    let found = find(Files::Given(files), &sorted.grooms, &sorted.heads(), options)?;
    Ok(found.map(|(path, cooked)| (path.to_path_buf(), cooked)))
}

pub(super) fn find<'a, P: AsRef<Path>>(
    from: Files<'_>,
    paths: &'a [P],
    heads: &Heads<'_>,
    options: &ImportOptions,
) -> Result<Option<(&'a Path, Cooked)>> {
    let Some(path) = paths.iter().map(AsRef::as_ref).find(|path| is_cooked(path)) else { return Ok(None) };
    let wrong =
        |problem: &str| Error::File { path: path.to_path_buf(), at: At::File, problem: problem.into() };
    if paths.len() > 1 || !heads.paths.is_empty() {
        return Err(wrong("a cooked groom has its head and all its strands: give it alone"));
    }
    let ImportOptions { orient, orient_head, moment, .. } = options;
    if [orient, orient_head].iter().any(|choice| **choice != Default::default()) {
        return Err(wrong("a cooked groom is in metres and upright: nothing of that can be chosen"));
    }
    if *moment != Moment::First {
        return Err(wrong("a cooked groom does not move, so no frame of it can be chosen"));
    }
    Ok(Some((path, Cooked::read(path, &from.load(path)?)?)))
}
