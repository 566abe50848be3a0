//! Imports grooms and heads from files.
//!
//! [`read`] reads the files of one groom, joins them, converts them to meters, Y up, face +Z, and repairs geometry that
//! later stages cannot handle. [`read_with_head`] also reads the mesh that the groom grows on, and uses each to orient
//! the other. Each file is loaded completely, and the sizes in its header are checked against its length.

#[cfg(feature = "cooked")]
mod cooked;
#[cfg(feature = "edit")]
mod edited;
mod join;
mod kind;
pub mod mesh;

#[cfg(feature = "cooked")]
pub use cooked::{cooked, given_cooked};
#[cfg(feature = "edit")]
pub use edited::{edited, edited_body, edited_complete, given_edited, given_head_files, head_files};
pub use kind::{FileKind, holds_body, kind};

pub use crate::{
    formats::{raw::Moment, source::FileBytes},
    report::{Attributes, FileReport, ImportReport, StrandGroup},
};

use std::{collections::BTreeMap, path::Path};

use crate::{
    Rig, Strands, TriMesh,
    error::{At, Error, Result},
    formats::{self, FileFormat, source::Files},
    light::PunctualLight,
    lint,
    orient::{self, KnownOrientation},
};

/// Options for reading files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Known unit and axes of the groom; the rest is guessed.
    pub orient: orient::OrientationOverride,
    /// Known unit and axes of the head; the rest is guessed.
    pub orient_head: orient::OrientationOverride,
    /// Whether numbers that are not finite are kept for the lint to count. Otherwise they are errors.
    pub allows_non_finite: bool,
    /// Whether to skip [`lint::repair`].
    pub skips_repair: bool,
    /// Moment of an animated file to read.
    pub moment: Moment,
}

/// Returns the groups of `strands`.
fn groups(strands: &Strands, names: &BTreeMap<i32, String>) -> Vec<StrandGroup> {
    let mut all: BTreeMap<i32, StrandGroup> = BTreeMap::new();
    for mark in &strands.marks {
        let name = || names.get(&mark.group).cloned().unwrap_or_default();
        let group = all.entry(mark.group).or_insert_with(|| StrandGroup {
            id: mark.group,
            name: name(),
            ..Default::default()
        });
        group.strands += 1;
        group.guides += usize::from(mark.guide);
    }
    // A single group without a name carries no information.
    if all.len() == 1 && names.is_empty() { Vec::new() } else { all.into_values().collect() }
}

/// A head or whole character from files, in meters, Y up, face +Z.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedBody {
    /// The mesh at rest.
    pub mesh: TriMesh,
    /// Rig with the same vertices in the same order, if the files have one.
    pub rig: Option<Rig>,
    /// Lights in the files.
    pub lights: Vec<PunctualLight>,
    /// Transform from the files to meters, Y up, face +Z.
    pub placement: orient::Placement,
}

/// Reads one groom from one or more files and orients it without a head.
pub fn read<P: AsRef<Path>>(paths: &[P], options: &ImportOptions) -> Result<(Strands, ImportReport)> {
    let (strands, _, report) = read_all(Files::Disk, paths, Heads::none(), options)?;
    Ok((strands, report))
}

/// Reads one groom from one or more files, and the head it grows on from one or more mesh files (head, eyes, …) that
/// share one unit and one set of axes. Orients both.
pub fn read_with_head<P: AsRef<Path>, H: AsRef<Path>>(
    paths: &[P],
    heads: &[H],
    options: &ImportOptions,
) -> Result<(Strands, TriMesh, ImportReport)> {
    if heads.is_empty() {
        return Err(Error::Unusable("no head mesh is given".into()));
    }
    let (strands, head, report) = read_all(Files::Disk, paths, Heads::of(heads), options)?;
    Ok((strands, head.unwrap_or_default(), report))
}

/// Reads one groom with its head: the meshes `heads` or, if there are none, those in the groom's own files
/// ([`holds_body`]), if any.
///
/// # Errors
/// See [`read`].
pub fn read_complete<P: AsRef<Path>, H: AsRef<Path>>(
    paths: &[P],
    heads: &[H],
    options: &ImportOptions,
) -> Result<(Strands, Option<TriMesh>, ImportReport)> {
    let mut all = Heads::of(heads);
    if all.paths.is_empty() {
        all.own = true;
        for path in paths.iter().map(AsRef::as_ref).filter(|path| may_hold_body(path)) {
            // The groom reader reports files that cannot be read.
            if std::fs::read(path).is_ok_and(|bytes| holds_body(path, &bytes)) {
                all.paths.push(path);
            }
        }
    }
    read_all(Files::Disk, paths, all, options)
}

/// [`read_complete`] for files in memory, for example in a browser. `files` are sorted by [`kind`]: the grooms are
/// joined, and the meshes make the head. Without meshes, the head is the one in the grooms' own files, if any.
/// Companions (`.mtl`, `.bin`) are found by the files that refer to them.
///
/// # Errors
/// The errors of [`read`], and [`Error::File`] for a file of unknown kind or a missing companion.
pub fn read_given(
    files: &[FileBytes<'_>],
    options: &ImportOptions,
) -> Result<(Strands, Option<TriMesh>, ImportReport)> {
    let sorted = SortedFiles::new(files)?;
    if let ([], [mesh, ..]) = (&sorted.grooms[..], &sorted.meshes[..]) {
        let problem = "the file is a mesh, not a groom; add a groom to use it as the head".into();
        return Err(Error::File { path: mesh.to_path_buf(), at: At::File, problem });
    }
    read_all(Files::Given(files), &sorted.grooms, sorted.heads(), options)
}

/// [`read_head`] for files in memory: the meshes among `files` and their companions.
///
/// # Errors
/// See [`read_given`].
pub fn read_given_head(
    files: &[FileBytes<'_>],
    options: &ImportOptions,
) -> Result<(TriMesh, orient::Placement)> {
    read_given_body(files, options).map(|body| (body.mesh, body.placement))
}

/// [`read_body`] for files in memory: the meshes among `files` and their companions.
///
/// # Errors
/// See [`read_given`].
pub fn read_given_body(files: &[FileBytes<'_>], options: &ImportOptions) -> Result<ImportedBody> {
    let sorted = SortedFiles::new(files)?;
    body_of(Files::Given(files), &sorted.meshes, options)
}

/// Files in memory, sorted by kind.
struct SortedFiles<'a> {
    grooms: Vec<&'a Path>,
    meshes: Vec<&'a Path>,
    /// Grooms that also hold a mesh.
    bodies: Vec<&'a Path>,
}

impl<'a> SortedFiles<'a> {
    fn new(files: &'a [FileBytes<'_>]) -> Result<Self> {
        let mut sorted = Self { grooms: Vec::new(), meshes: Vec::new(), bodies: Vec::new() };
        for (name, bytes) in files {
            match kind(name, bytes) {
                Some(FileKind::Groom) => {
                    sorted.grooms.push(name);
                    sorted.bodies.extend(holds_body(name, bytes).then_some(&**name));
                }
                Some(FileKind::Mesh) => sorted.meshes.push(name),
                Some(FileKind::Resource) => {}
                None => {
                    let grooms = formats::listed(formats::GROOMS, "or");
                    let what = format!("a groom is a {grooms} file, a head");
                    return Err(FileFormat::unread(name, &what, formats::MESHES));
                }
            }
        }
        Ok(sorted)
    }

    /// Returns the meshes or, if there are none, the grooms that also hold a mesh.
    fn heads(&self) -> Heads<'a> {
        let own = self.meshes.is_empty();
        Heads { paths: if own { self.bodies.clone() } else { self.meshes.clone() }, own }
    }
}

/// Returns whether a groom with this name may hold a mesh.
fn may_hold_body(path: &Path) -> bool {
    FileFormat::of(path).is_some_and(|format| format.holds_body.is_some())
}

/// The files of a head.
struct Heads<'a> {
    paths: Vec<&'a Path>,
    /// Whether they are the groom's own files, which state how hair and head relate.
    own: bool,
}

impl<'a> Heads<'a> {
    fn none() -> Self {
        Self { paths: Vec::new(), own: false }
    }

    fn of<H: AsRef<Path>>(heads: &'a [H]) -> Self {
        Self { paths: heads.iter().map(AsRef::as_ref).collect(), own: false }
    }
}

/// Checks that the complete groom at `path` is the only one of `count` files, and that the options do not contradict
/// what its file states.
#[cfg(any(feature = "cooked", feature = "edit"))]
fn check_single(path: &Path, count: usize, heads: &Heads<'_>, options: &ImportOptions) -> Result<()> {
    let kind = if formats::is_cooked(path) { "a cooked groom" } else { "an edited groom" };
    let wrong = |problem: &str| {
        Err(Error::File { path: path.to_path_buf(), at: At::File, problem: format!("{kind} {problem}") })
    };
    if count > 1 || !heads.paths.is_empty() {
        return wrong("includes its head and all its strands; do not add other files");
    }
    let ImportOptions { orient, orient_head, moment, .. } = options;
    if [orient, orient_head].iter().any(|choice| **choice != Default::default()) {
        return wrong("is in meters and upright; unit and axes cannot be set");
    }
    if *moment != Moment::First {
        return wrong("is not animated; a frame cannot be selected");
    }
    Ok(())
}

/// Reads a head without a groom and orients it.
pub fn read_head<H: AsRef<Path>>(
    heads: &[H],
    options: &ImportOptions,
) -> Result<(TriMesh, orient::Placement)> {
    read_body(heads, options).map(|body| (body.mesh, body.placement))
}

/// [`read_head`] with the head's rig.
pub fn read_body<H: AsRef<Path>>(heads: &[H], options: &ImportOptions) -> Result<ImportedBody> {
    body_of(Files::Disk, heads, options)
}

fn body_of<H: AsRef<Path>>(files: Files<'_>, heads: &[H], options: &ImportOptions) -> Result<ImportedBody> {
    options.orient_head.check()?;
    let mut raw = mesh::read_from(files, heads)?;
    let known = KnownOrientation { given: options.orient_head, declared: raw.declared };
    let mut placement = orient::head(&raw.mesh, &known);
    placement.doubts.append(&mut raw.notes);
    orient_mesh(&mut raw, &placement);
    Ok(ImportedBody { mesh: raw.mesh, rig: raw.rig, lights: raw.lights, placement })
}

/// Transforms a mesh with its rig and lights to meters, Y up, face +Z.
fn orient_mesh(raw: &mut mesh::RawMesh, placement: &orient::Placement) {
    placement.apply_to_mesh(&mut raw.mesh);
    if let Some(rig) = &mut raw.rig {
        placement.apply_to_rig(rig);
    }
    placement.apply_to_lights(&mut raw.lights);
}

fn read_all<P: AsRef<Path>>(
    from: Files<'_>,
    paths: &[P],
    heads: Heads<'_>,
    options: &ImportOptions,
) -> Result<(Strands, Option<TriMesh>, ImportReport)> {
    options.orient.check()?;
    options.orient_head.check()?;
    #[cfg(feature = "cooked")]
    if let Some((path, cooked)) = cooked::find(from, paths, &heads, options)? {
        let mut report = cooked.report(path);
        report.rig = cooked.rig;
        return Ok((cooked.strands, cooked.head, report));
    }
    #[cfg(feature = "edit")]
    if let Some((path, document)) = edited::find(from, paths, &heads, options)? {
        return edited_complete(path, &document);
    }
    // Lights of files that are read as heads too come with the heads.
    let (raw, files) = join::read(from, paths, &heads.paths, options)?;
    let (mut strands, mut followers, mut lights) = (raw.strands, raw.followers, raw.lights.lights);
    let mut head = if heads.paths.is_empty() { None } else { Some(mesh::read_from(from, &heads.paths)?) };
    let known = KnownOrientation { given: options.orient, declared: raw.declared };
    let (placement, mut head_placement) = match &head {
        // A file that states its unit and axes needs no comparison with the head.
        Some(head) if heads.own && raw.declared == orient::OrientationOverride::METERS => {
            let given = options.orient_head.or(options.orient);
            let of_head = KnownOrientation { given, declared: head.declared };
            (orient::groom(&strands, &known), Some(orient::head(&head.mesh, &of_head)))
        }
        Some(head) => {
            let of_head = KnownOrientation { given: options.orient_head, declared: head.declared };
            let (groom, head) = orient::pair(&strands, &known, &head.mesh, &of_head);
            (groom, Some(head))
        }
        None => (orient::groom(&strands, &known), None),
    };
    if let (Some(placement), Some(head)) = (&mut head_placement, &mut head) {
        placement.doubts.append(&mut head.notes);
    }
    placement.apply(&mut strands);
    placement.apply_to_lights(&mut lights);
    for radius in followers.iter_mut().filter_map(|followers| followers.radius.as_mut()) {
        *radius *= placement.unit.0;
    }
    if let (Some(head), Some(placement)) = (&mut head, &head_placement) {
        orient_mesh(head, placement);
        lights.append(&mut head.lights);
    }
    let (head, rig) = head.map_or((None, None), |h| (Some(h.mesh), h.rig));
    let (groups, attributes) = (groups(&strands, &raw.group_names), Attributes::of(&strands));
    let lint = lint::check(&strands, head.as_ref());
    let mut repaired = lint::RepairReport::default();
    if !options.skips_repair {
        let left;
        (repaired, left) = lint::repair_kept(&mut strands);
        if !followers.is_empty() {
            followers = left.iter().map(|i| followers[*i as usize]).collect();
        }
        if strands.is_empty() {
            let path = paths.first().map(|p| p.as_ref().to_path_buf()).unwrap_or_default();
            let problem = "no strand is usable: each has zero length or a single vertex".into();
            return Err(Error::File { path, at: At::File, problem });
        }
    }
    let report = ImportReport {
        files,
        placement,
        head_placement,
        rig,
        lights,
        lint,
        repaired,
        followers,
        groups,
        attributes,
        look: raw.look,
    };
    Ok((strands, head, report))
}

#[cfg(test)]
mod tests;
