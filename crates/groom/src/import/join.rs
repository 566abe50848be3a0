//! Joining several files into one groom: a hairstyle in four `.tfx` files is one hairstyle.

use std::path::Path;

use super::{FileReport, Files, ImportOptions, Raw, Source, parse_source};
use crate::{
    error::{Error, Result},
    strands::Mark,
};

/// Reads and joins files that share one unit and one set of axes.
pub(super) fn read<P: AsRef<Path>>(
    files: Files<'_>,
    paths: &[P],
    options: &ImportOptions,
) -> Result<(Raw, Vec<FileReport>)> {
    let mut reports: Vec<FileReport> = Vec::new();
    let mut joined: Option<Raw> = None;
    for path in paths {
        let path = path.as_ref();
        let raw = {
            let bytes = files.load(path)?;
            parse_source(&Source { path, bytes: &bytes, files, lenient: options.lenient }, options.moment)?
        };
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
                let notes = append(&mut all, raw);
                if let (Some(report), false) = (reports.last_mut(), notes.is_empty()) {
                    report.notes.extend(notes);
                }
                if all.strands.positions.len() as u64 > super::MAX_VERTICES {
                    let limit = super::MAX_VERTICES;
                    return Err(Error::Unusable(format!(
                        "{} and the files before it have more than the {limit} vertices that fit in the largest GPU buffer",
                        path.display()
                    )));
                }
                all
            }
        });
    }
    joined.map(|all| (all, reports)).ok_or_else(|| Error::Unusable("no groom file is given".into()))
}

/// Adds `more`. An attribute lives on only where both have it; pinned tips and followers are joined in any case.
pub(super) fn append(all: &mut Raw, more: Raw) -> Vec<String> {
    let mut notes = Vec::new();
    all.look = all.look.or(more.look);
    let (a, b) = (&mut all.strands, more.strands);
    let (before, added) = (a.len(), b.len());
    let base = a.positions.len() as u32;
    a.positions.extend(b.positions);
    a.offsets.extend(b.offsets.iter().skip(1).map(|o| o.saturating_add(base)));
    join(&mut a.radii, b.radii, "thickness", &mut notes);
    join(&mut a.colors, b.colors, "colour", &mut notes);
    join(&mut a.root_uvs, b.root_uvs, "texture coordinates", &mut notes);
    if !a.tip_pinned.is_empty() || !b.tip_pinned.is_empty() {
        a.tip_pinned.resize(before, false);
        a.tip_pinned.extend(b.tip_pinned);
        a.tip_pinned.resize(before + added, false);
    }
    if !all.followers.is_empty() || !more.followers.is_empty() {
        all.followers.resize(before, Default::default());
        all.followers.extend(more.followers);
        all.followers.resize(before + added, Default::default());
    }
    if !a.marks.is_empty() || !b.marks.is_empty() {
        // Each file counts its strands for itself.
        let free = a.marks.iter().map(|mark| mark.id).max().map_or(0, |most| most.saturating_add(1));
        a.marks.resize(before, Mark::default());
        a.marks.extend(b.marks.into_iter().map(|mark| Mark {
            id: mark.id.saturating_add(free),
            closest: mark.closest.map(|id| id.saturating_add(free)),
            ..mark
        }));
        a.marks.resize(before + added, Mark::default());
    }
    for (group, name) in more.group_names {
        all.group_names.entry(group).or_insert(name);
    }
    all.declared = all.declared.shared(more.declared);
    notes
}

fn join<T>(a: &mut Vec<T>, b: Vec<T>, what: &str, notes: &mut Vec<String>) {
    if a.is_empty() != b.is_empty() {
        notes.push(format!("not every file has {what}, so none is used"));
        a.clear();
    } else {
        a.extend(b);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::Strands;

    #[test]
    fn attributes_of_one_file_only_are_dropped_and_pins_kept() {
        let mut one = Raw::new("one");
        one.strands.push(&[Vec3::ZERO, Vec3::X]);
        one.strands.radii = vec![1.0; 2];
        let mut two = Raw::new("two");
        two.strands.push(&[Vec3::Y, Vec3::Z]);
        two.strands.tip_pinned = vec![true];
        let notes = append(&mut one, two);
        assert_eq!(notes.len(), 1);
        let expected = Strands {
            offsets: vec![0, 2, 4],
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            tip_pinned: vec![false, true],
            ..Default::default()
        };
        assert_eq!(one.strands, expected);
    }
}
