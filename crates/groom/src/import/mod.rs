//! Grooms and heads from files.
//!
//! [`read`] takes the files of one groom, joins them, converts them to metres, Y up, face +Z and repairs
//! what would cause trouble later; [`read_with_head`] does so for a groom and the mesh it grows on, and
//! uses each to orient the other. A file is first read whole, and no size in its header is trusted before
//! it fits into the bytes that are there.

#[cfg(feature = "alembic")]
mod abc;
#[cfg(any(feature = "alembic", feature = "usd"))]
mod basis;
#[cfg(feature = "cooked")]
mod cooked;
#[cfg(any(feature = "alembic", feature = "usd"))]
mod curves;
mod data;
mod files;
mod hair;
mod join;
pub mod mesh;
mod obj_lines;
mod ply;
mod source;
mod tfx_binary;
mod tfx_text;
#[cfg(feature = "usd")]
mod usd;

pub(crate) use hair::{CENTIMETRES, COLORS, MARK, POINTS, SEGMENTS, THICKNESS};
pub(crate) use source::Source;

#[cfg(feature = "cooked")]
pub use cooked::{cooked, given_cooked};
use files::Files;
pub use files::{Given, Kind, holds_body, kind};
#[cfg(feature = "gltf")]
pub(crate) use mesh::gltf::{
    hair::{GUIDE, NAME as HAIR_EXTENSION, TIP_PINNED},
    packed::NAME as PACKED_EXTENSION,
};

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{Followers, Look, Rig, Strands, TriMesh, formats, lint, orient};
use crate::error::{At, Error, Result};

/// The most vertices a groom may have: 16 bytes each fill the largest buffer that WebGPU can bind.
pub const MAX_VERTICES: u64 = 1 << 28;

/// Which moment of an animated file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Moment {
    /// Its first frame.
    #[default]
    First,
    /// A frame by its number, from 0 on.
    Frame(u32),
    /// The frame nearest to this time, seconds.
    Seconds(f64),
}

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

/// What one file held.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileReport {
    /// The file.
    pub path: PathBuf,
    /// Format and version.
    pub format: &'static str,
    /// Strands in it.
    pub strands: usize,
    /// Vertices in it.
    pub vertices: usize,
    /// What was done on the way, or left out.
    pub notes: Vec<String>,
}

/// What was read and what was done with it.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportReport {
    /// One per groom file, in the order given.
    pub files: Vec<FileReport>,
    /// How the groom came into metres, Y up, face +Z.
    pub placement: orient::Placement,
    /// How the head did.
    pub head_placement: Option<orient::Placement>,
    /// What bends the head, if its files have that.
    pub rig: Option<Rig>,
    /// What the groom was like before the repair.
    pub lint: lint::Report,
    /// What the repair did.
    pub repaired: lint::Repaired,
    /// The followers that the files ask for, one entry per strand, radii in metres; empty where none do.
    pub followers: Vec<Followers>,
    /// The groups that the files sort their strands into, by number; empty where they do not.
    pub groups: Vec<Group>,
    /// What attributes the files have of each strand or vertex.
    pub attributes: Attributes,
    /// What the first file that says so has its hair look like.
    pub look: Option<Look>,
}

/// Strands that belong together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Group {
    /// Its number.
    pub id: i32,
    /// Its name, where the file has one.
    pub name: String,
    /// Strands in it, guides among them.
    pub strands: usize,
    /// Guides in it.
    pub guides: usize,
}

/// Which attributes there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Attributes {
    /// A width at each vertex.
    pub widths: bool,
    /// A colour at each vertex.
    pub colors: bool,
    /// Scalp texture coordinates.
    pub root_uvs: bool,
    /// Strands have numbers.
    pub ids: bool,
    /// Strands that are guides.
    pub guides: usize,
    /// Strands that say which guides they follow.
    pub bound: usize,
}

impl Attributes {
    fn of(strands: &Strands) -> Self {
        Self {
            widths: !strands.radii.is_empty(),
            colors: !strands.colors.is_empty(),
            root_uvs: !strands.root_uvs.is_empty(),
            ids: !strands.marks.is_empty(),
            guides: strands.marks.iter().filter(|mark| mark.guide).count(),
            bound: strands.marks.iter().filter(|mark| mark.weights != [0.0; 3]).count(),
        }
    }
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

impl ImportReport {
    /// How many strands there are with all followers that the files ask for.
    pub fn with_followers(&self) -> u64 {
        self.followers.iter().map(|followers| 1 + u64::from(followers.count)).sum()
    }
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

/// One file as it is, in its own unit and axes.
pub(crate) struct Raw {
    pub strands: Strands,
    pub format: &'static str,
    pub notes: Vec<String>,
    /// What the file itself says of its unit and axes.
    pub declared: orient::Choice,
    /// The followers of each strand, in the file's unit; empty for none.
    pub followers: Vec<Followers>,
    /// The names of groups, by number.
    pub group_names: BTreeMap<i32, String>,
    /// What its hair looks like.
    pub look: Option<Look>,
}

/// What a text in a file says of its unit and axes: what the writer puts there.
pub(crate) fn declared(text: &str) -> orient::Choice {
    match text {
        _ if text.contains(CENTIMETRES) => {
            orient::Choice { unit: Some(orient::Unit(0.01)), ..orient::Choice::METRES }
        }
        _ if text.contains(MARK) => orient::Choice::METRES,
        _ => orient::Choice::default(),
    }
}

impl Raw {
    pub fn new(format: &'static str) -> Self {
        Self {
            strands: Strands::default(),
            format,
            look: None,
            notes: Vec::new(),
            declared: orient::Choice::default(),
            followers: Vec::new(),
            group_names: BTreeMap::new(),
        }
    }

    /// Gives every strand `count` followers within `radius`, as the header has them.
    pub fn follow(&mut self, count: u64, radius: Option<f32>) {
        if count == 0 {
            return;
        }
        // Nothing is within a radius of 0: whoever wrote it did not say.
        let radius = radius.filter(|radius| *radius > 0.0);
        let within = radius.map_or(String::new(), |radius| format!(" within {radius} of its unit"));
        self.notes.push(format!("asks for {count} followers of each strand{within}"));
        let followers = Followers { count: u32::try_from(count).unwrap_or(u32::MAX), radius };
        self.followers = vec![followers; self.strands.len()];
    }
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
        for path in paths.iter().map(AsRef::as_ref).filter(|path| formats::may_hold_body(path)) {
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
                    let [grooms, meshes] =
                        [formats::GROOMS, formats::MESHES].map(|all| formats::listed(all, "or"));
                    let problem = format!("a groom is a {grooms} file, a head an {meshes} file");
                    return Err(Error::File { path: name.clone(), at: At::File, problem });
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
    let mut placement = orient::head(&raw, &options.orient_head);
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
    let (placement, mut head_placement) = match &head {
        // What says all of it needs no head to compare with.
        Some(head) if heads.own && raw.declared == orient::Choice::METRES => {
            let groom = orient::groom(&strands, &raw.declared, &options.orient);
            (groom, Some(orient::head(head, &options.orient_head.or(options.orient))))
        }
        Some(head) => {
            let (groom, head) = orient::pair(&strands, &raw.declared, head, options);
            (groom, Some(head))
        }
        None => (orient::groom(&strands, &raw.declared, &options.orient), None),
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

/// One groom file from its bytes, as it is; `path` decides the format and stands in errors.
pub(crate) fn parse(path: &Path, bytes: &[u8], lenient: bool) -> Result<Raw> {
    parse_at(path, bytes, lenient, Moment::First)
}

/// The same at one moment, where the file is animated.
pub(crate) fn parse_at(path: &Path, bytes: &[u8], lenient: bool, moment: Moment) -> Result<Raw> {
    parse_source(&Source { path, bytes, files: Files::Given(&[]), lenient }, moment)
}

/// The same, and what it refers to beside it.
fn parse_source(source: &Source, moment: Moment) -> Result<Raw> {
    let Source { path, bytes, .. } = *source;
    let raw = match formats::extension(path).as_str() {
        _ if bytes.is_empty() => return Err(source.problem(At::Byte(0), "the file is empty")),
        "tfx" if starts_with_word(bytes) => tfx_text::read(source)?,
        "tfx" => tfx_binary::read(source)?,
        "hair" => hair::read(source)?,
        "obj" => obj_lines::read(source)?,
        "data" => data::read(source)?,
        "ply" => ply::read(source)?,
        #[cfg(feature = "gltf")]
        "glb" | "gltf" => mesh::gltf::hair::read(source)?,
        #[cfg(feature = "alembic")]
        "abc" => abc::read(source, moment)?,
        #[cfg(feature = "usd")]
        "usd" | "usda" | "usdc" | "usdz" => usd::read(source, moment)?,
        #[cfg(feature = "cooked")]
        "tresses" => {
            return Err(
                source.problem(At::File, "a cooked groom stands for itself: it is no part of another")
            );
        }
        mesh if formats::MESHES.contains(&mesh) => {
            return Err(source.problem(At::File, "a mesh, not a groom; it can be the head of one"));
        }
        _ => {
            let grooms = formats::listed(formats::GROOMS, "or");
            return Err(source.problem(At::File, format!("a groom is a {grooms} file")));
        }
    };
    if !matches!(moment, Moment::First) && !formats::ANIMATED.contains(&formats::extension(path).as_str()) {
        return Err(source.problem(At::File, "a format without frames, so none can be chosen"));
    }
    if raw.strands.is_empty() {
        return Err(source.problem(At::File, "the file holds no strands"));
    }
    source.check_vertices(0, raw.strands.positions.len() as u64)?;
    Ok(raw)
}

/// Whether a `.tfx` file is text: a version number as a float always has a byte outside ASCII text.
fn starts_with_word(bytes: &[u8]) -> bool {
    let first = bytes.iter().find(|b| !b.is_ascii_whitespace());
    first.is_some_and(|b| b.is_ascii_alphabetic() || *b == b'#')
}

/// A whole file, or the error that names it.
pub(crate) fn load(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|source| Error::Io { path: path.to_path_buf(), source })
}

#[cfg(test)]
mod tests;
