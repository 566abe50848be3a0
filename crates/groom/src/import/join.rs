//! Joins several files into one groom, for example a hairstyle in four `.tfx` files.

use std::path::Path;

use super::{FileReport, ImportOptions};
use crate::formats::parse::parse_source;
use crate::{
    MAX_VERTICES,
    error::{Error, Result},
    formats::{
        raw::{Raw, RawLights},
        source::{Files, Source},
    },
};

/// Reads and joins files that share one unit and one set of axes. Omits the lights of the files that are also `heads`.
pub(super) fn read<P: AsRef<Path>>(
    files: Files<'_>,
    paths: &[P],
    heads: &[&Path],
    options: &ImportOptions,
) -> Result<(Raw, Vec<FileReport>)> {
    let mut reports: Vec<FileReport> = Vec::new();
    let mut joined: Option<Raw> = None;
    for path in paths {
        let path = path.as_ref();
        let mut raw = {
            let bytes = files.load(path)?;
            parse_source(
                &Source { path, bytes: &bytes, files, lenient: options.allows_non_finite },
                options.moment,
            )?
        };
        if heads.contains(&path) {
            raw.lights = RawLights::default();
        }
        raw.notes.append(&mut raw.lights.notes);
        reports.push(FileReport {
            path: path.to_path_buf(),
            format: raw.format,
            strands: raw.strands.len(),
            vertices: raw.strands.positions.len(),
            notes: raw.notes.clone(),
        });
        joined = Some(match joined {
            None => raw,
            Some(mut all) => {
                let notes = all.append(raw);
                if let (Some(report), false) = (reports.last_mut(), notes.is_empty()) {
                    report.notes.extend(notes);
                }
                if all.strands.positions.len() as u64 > MAX_VERTICES {
                    return Err(Error::Unusable(format!(
                        "{} and the files before it have more than the {MAX_VERTICES} vertices that fit in the largest GPU buffer",
                        path.display()
                    )));
                }
                all
            }
        });
    }
    joined.map(|all| (all, reports)).ok_or_else(|| Error::Unusable("no groom file is given".into()))
}
