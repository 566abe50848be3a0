//! Grooms and heads from files.
//!
//! [`read`] takes the files of one groom, joins them, converts them to metres, Y up, face +Z and repairs
//! what would cause trouble later; [`read_with_head`] does so for a groom and the mesh it grows on, and
//! uses each to orient the other. A file is first read whole, and no size in its header is trusted before
//! it fits into the bytes that are there.

#[cfg(feature = "cooked")]
mod cooked;
mod join;
mod kind;
pub mod mesh;
mod parse;

#[cfg(feature = "cooked")]
pub use cooked::{cooked, given_cooked};
pub use kind::{Kind, holds_body, kind};
pub(crate) use parse::parse;
#[cfg(test)]
pub(crate) use parse::parse_at;

pub use crate::{
    formats::{raw::Moment, source::Given},
    report::{Attributes, FileReport, Group, ImportReport},
};

use std::{collections::BTreeMap, path::Path};

use crate::{
    Rig, Strands, TriMesh,
    error::{At, Error, Result},
    formats::{self, Format, source::Files},
    lint,
    orient::{self, Known},
};

/// How files are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// What is known of the groom's unit and axes; the rest is guessed.
    pub orient: orient::Choice,
    /// What is known of the head's unit and axes; the rest is guessed.
    pub orient_head: orient::Choice,
    /// Whether numbers that are not finite are kept for a lint to count, instead of an error.
    pub lenient: bool,
    /// Whether the groom is left as the files have it, without [`lint::repair`].
    pub unrepaired: bool,
    /// Which moment of an animated file is read.
    pub moment: Moment,
}

/// The groups of `strands`.
fn groups(strands: &Strands, names: &BTreeMap<i32, String>) -> Vec<Group> {
    let mut all: BTreeMap<i32, Group> = BTreeMap::new();
    for mark in &strands.marks {
        let name = || names.get(&mark.group).cloned().unwrap_or_default();
        let group = all.entry(mark.group).or_insert_with(|| Group {
            id: mark.group,
            name: name(),
            ..Default::default()
        });
        group.strands += 1;
        group.guides += usize::from(mark.guide);
    }
    // One nameless group is none.
    if all.len() == 1 && names.is_empty() { Vec::new() } else { all.into_values().collect() }
}

/// A head or body from files, in metres, Y up, face +Z.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// At rest.
    pub mesh: TriMesh,
    /// What bends it, with the same vertices in the same order, if its files have that.
    pub rig: Option<Rig>,
    /// How it came into metres, Y up, face +Z.
    pub placement: orient::Placement,
}

/// Reads one groom from one or more files and orients it by itself.
pub fn read<P: AsRef<Path>>(paths: &[P], options: &ImportOptions) -> Result<(Strands, ImportReport)> {
    let (strands, _, report) = read_all(Files::Disk, paths, Heads::none(), options)?;
    Ok((strands, report))
}

/// Reads one groom from one or more files and the head it grows on from one or more mesh files
/// (head, eyes, …, all in one unit and one set of axes), and orients both.
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

/// Reads one groom with its head: that of `heads`, or else the body that the groom's files hold themselves
/// ([`holds_body`]), or else none.
///
/// # Errors
/// As [`read`].
pub fn read_whole<P: AsRef<Path>, H: AsRef<Path>>(
    paths: &[P],
    heads: &[H],
    options: &ImportOptions,
) -> Result<(Strands, Option<TriMesh>, ImportReport)> {
    let mut all = Heads::of(heads);
    if all.paths.is_empty() {
        all.own = true;
        for path in paths.iter().map(AsRef::as_ref).filter(|path| may_hold_body(path)) {
            // What cannot be read, the reader of the groom says.
            if std::fs::read(path).is_ok_and(|bytes| holds_body(path, &bytes)) {
                all.paths.push(path);
            }
        }
    }
    read_all(Files::Disk, paths, all, options)
}

/// The same from bytes, for a browser: of `files` the grooms are joined, the meshes make the head, and
/// companions (`.mtl`, `.bin`) are found by those that name them, by [`kind`]. Without a mesh there is no
/// head.
///
/// # Errors
/// As [`read`], and [`Error::File`] for a file of no known kind, or when a file that another one needs is
/// not among them.
pub fn read_given(
    files: &[Given<'_>],
    options: &ImportOptions,
) -> Result<(Strands, Option<TriMesh>, ImportReport)> {
    let sorted = Sorted::new(files)?;
    if let ([], [mesh, ..]) = (&sorted.grooms[..], &sorted.meshes[..]) {
        let problem = "a mesh, not a groom; it can be the head of one that is given with it".into();
        return Err(Error::File { path: mesh.to_path_buf(), at: At::File, problem });
    }
    read_all(Files::Given(files), &sorted.grooms, sorted.heads(), options)
}

/// [`read_head`] from bytes: the meshes among `files` and their companions.
///
/// # Errors
/// As [`read_given`].
pub fn read_given_head(files: &[Given<'_>], options: &ImportOptions) -> Result<(TriMesh, orient::Placement)> {
    read_given_body(files, options).map(|body| (body.mesh, body.placement))
}

/// [`read_body`] from bytes: the meshes among `files` and their companions.
///
/// # Errors
/// As [`read_given`].
pub fn read_given_body(files: &[Given<'_>], options: &ImportOptions) -> Result<Body> {
    let sorted = Sorted::new(files)?;
    body_of(Files::Given(files), &sorted.meshes, options)
}

/// Given files by what they are.
struct Sorted<'a> {
    grooms: Vec<&'a Path>,
    meshes: Vec<&'a Path>,
    /// Grooms that have a body with them.
    bodies: Vec<&'a Path>,
}

impl<'a> Sorted<'a> {
    fn new(files: &'a [Given<'_>]) -> Result<Self> {
        let mut sorted = Self { grooms: Vec::new(), meshes: Vec::new(), bodies: Vec::new() };
        for (name, bytes) in files {
            match kind(name, bytes) {
                Some(Kind::Groom) => {
                    sorted.grooms.push(name);
                    sorted.bodies.extend(holds_body(name, bytes).then_some(&**name));
                }
                Some(Kind::Mesh) => sorted.meshes.push(name),
                Some(Kind::Companion) => {}
                None => {
                    let grooms = formats::listed(formats::GROOMS, "or");
                    let what = format!("a groom is a {grooms} file, a head");
                    return Err(Format::unread(name, &what, formats::MESHES));
                }
            }
        }
        Ok(sorted)
    }

    /// The meshes, or else the bodies that grooms have with them.
    fn heads(&self) -> Heads<'a> {
        let own = self.meshes.is_empty();
        Heads { paths: if own { self.bodies.clone() } else { self.meshes.clone() }, own }
    }
}

/// Whether a groom with this name may hold its body.
fn may_hold_body(path: &Path) -> bool {
    Format::of(path).is_some_and(|format| format.holds_body.is_some())
}

/// The files of a head.
struct Heads<'a> {
    paths: Vec<&'a Path>,
    /// Whether they are those of the groom, which say themselves how both lie to each other.
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

/// Reads a head without a groom and orients it.
pub fn read_head<H: AsRef<Path>>(
    heads: &[H],
    options: &ImportOptions,
) -> Result<(TriMesh, orient::Placement)> {
    read_body(heads, options).map(|body| (body.mesh, body.placement))
}

/// [`read_head`] with what bends it.
pub fn read_body<H: AsRef<Path>>(heads: &[H], options: &ImportOptions) -> Result<Body> {
    body_of(Files::Disk, heads, options)
}

fn body_of<H: AsRef<Path>>(files: Files<'_>, heads: &[H], options: &ImportOptions) -> Result<Body> {
    options.orient_head.check()?;
    let mut raw = mesh::read_from(files, heads)?;
    let known = Known { given: options.orient_head, declared: raw.declared };
    let mut placement = orient::head(&raw.mesh, &known);
    placement.doubts.append(&mut raw.notes);
    place(&mut raw, &placement);
    Ok(Body { mesh: raw.mesh, rig: raw.rig, placement })
}

/// Brings a mesh and what bends it into metres, Y up, face +Z.
fn place(raw: &mut mesh::RawMesh, placement: &orient::Placement) {
    placement.apply_to_mesh(&mut raw.mesh);
    if let Some(rig) = &mut raw.rig {
        placement.apply_to_rig(rig);
    }
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
    let (raw, files) = join::read(from, paths, options)?;
    let (mut strands, mut followers) = (raw.strands, raw.followers);
    let mut head = if heads.paths.is_empty() { None } else { Some(mesh::read_from(from, &heads.paths)?) };
    let known = Known { given: options.orient, declared: raw.declared };
    let (placement, mut head_placement) = match &head {
        // What says all of it needs no head to compare with.
        Some(head) if heads.own && raw.declared == orient::Choice::METRES => {
            let given = options.orient_head.or(options.orient);
            let of_head = Known { given, declared: head.declared };
            (orient::groom(&strands, &known), Some(orient::head(&head.mesh, &of_head)))
        }
        Some(head) => {
            let of_head = Known { given: options.orient_head, declared: head.declared };
            let (groom, head) = orient::pair(&strands, &known, &head.mesh, &of_head);
            (groom, Some(head))
        }
        None => (orient::groom(&strands, &known), None),
    };
    if let (Some(placement), Some(head)) = (&mut head_placement, &mut head) {
        placement.doubts.append(&mut head.notes);
    }
    placement.apply(&mut strands);
    for radius in followers.iter_mut().filter_map(|followers| followers.radius.as_mut()) {
        *radius *= placement.unit.0;
    }
    if let (Some(head), Some(placement)) = (&mut head, &head_placement) {
        place(head, placement);
    }
    let (head, rig) = head.map_or((None, None), |h| (Some(h.mesh), h.rig));
    let (groups, attributes) = (groups(&strands, &raw.group_names), Attributes::of(&strands));
    let lint = lint::check(&strands, head.as_ref());
    let mut repaired = lint::Repaired::default();
    if !options.unrepaired {
        let left;
        (repaired, left) = lint::repair_kept(&mut strands);
        if !followers.is_empty() {
            followers = left.iter().map(|i| followers[*i as usize]).collect();
        }
        if strands.is_empty() {
            let path = paths.first().map(|p| p.as_ref().to_path_buf()).unwrap_or_default();
            let problem = "every strand has zero length or a single vertex, so nothing is left to use".into();
            return Err(Error::File { path, at: At::File, problem });
        }
    }
    let report = ImportReport {
        files,
        placement,
        head_placement,
        rig,
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
