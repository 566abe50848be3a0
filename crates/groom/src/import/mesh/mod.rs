//! Triangle meshes from OBJ, glTF/GLB, Alembic, USD and TressFX's text `.tfxmesh`.

#[cfg(feature = "gltf")]
pub(super) mod gltf;
mod obj;
mod tfxmesh;

use std::{path::Path, sync::Arc};

pub(crate) use super::Source;
use super::{Files, Given};
use crate::{
    TriMesh,
    error::{At, Error, Result},
    formats,
    mesh::Paint,
    orient::Choice,
    rig::Rig,
};

/// A mesh as its file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMesh {
    /// In the file's own unit and axes. Skins and shapes are at rest.
    pub mesh: TriMesh,
    /// What the file or its format says of unit and axes.
    pub declared: Choice,
    /// What bends the mesh, with the same vertices in the same order: where a file has a skin, shapes to
    /// blend or an animation.
    pub rig: Option<Rig>,
    /// What of the file was left out.
    pub notes: Vec<String>,
}

/// The most bytes that the pictures of several files may take.
#[cfg(feature = "textures")]
const ROOM: u64 = 1 << 30;

/// The body's colour where only some parts of a mesh have one: a neutral skin, linear.
const PLAIN: glam::Vec3 = glam::Vec3::new(0.45, 0.32, 0.265);

/// Reads one mesh, in the file's own unit and axes; [`crate::orient::head`] orients it. Normals
/// that the file lacks are computed, angle-weighted; colours are the materials' base colours.
pub fn read(path: &Path) -> Result<RawMesh> {
    parse(Files::Disk, path, &Files::Disk.load(path)?)
}

/// [`read`] from bytes: the mesh called `path` and what it needs are among `files`.
///
/// # Errors
/// As [`read`], and [`Error::File`] when a file that it needs is not among them.
pub fn read_given(files: &[Given<'_>], path: &Path) -> Result<RawMesh> {
    let files = Files::Given(files);
    parse(files, path, &files.load(path)?)
}

/// Reads several meshes that share one unit and one set of axes into one. If any of them has a rig, all
/// have one together: meshes without follow a node of their own, and what has one name in several files
/// (shapes, animations) is one.
pub fn read_all<P: AsRef<Path>>(paths: &[P]) -> Result<RawMesh> {
    read_from(Files::Disk, paths)
}

/// The same from any source of files.
pub(super) fn read_from<P: AsRef<Path>>(files: Files<'_>, paths: &[P]) -> Result<RawMesh> {
    let mut all: Option<RawMesh> = None;
    for path in paths {
        let path = path.as_ref();
        let part = parse(files, path, &files.load(path)?)?;
        all = Some(match all {
            None => part,
            Some(mut all) => {
                if all.rig.is_some() || part.rig.is_some() {
                    let rig = all.rig.get_or_insert_with(|| Rig::still(&all.mesh));
                    let more = part.rig.unwrap_or_else(|| Rig::still(&part.mesh));
                    rig.append(more).map_err(|e| at_file(path, e))?;
                }
                append(&mut all.mesh, part.mesh);
                all.notes.extend(part.notes);
                all.declared = all.declared.shared(part.declared);
                all
            }
        });
    }
    #[cfg(feature = "textures")]
    if let Some(paint) = all.as_mut().and_then(|all| all.mesh.paint.as_mut()) {
        // Pictures of several files have one size, too.
        Arc::make_mut(paint).level(ROOM);
    }
    all.ok_or_else(|| Error::Unusable("no head mesh is given".into()))
}

/// A mesh from its bytes; `path` decides the format and where among `files` materials and buffers are
/// looked for.
fn parse(files: Files<'_>, path: &Path, bytes: &[u8]) -> Result<RawMesh> {
    let source = Source { path, bytes, files, lenient: false };
    let mut raw = match formats::extension(path).as_str() {
        _ if bytes.is_empty() => return Err(source.problem(At::Byte(0), "the file is empty")),
        "obj" => RawMesh { mesh: obj::read(&source)?, ..RawMesh::default() },
        "tfxmesh" => RawMesh { mesh: tfxmesh::read(&source)?, ..RawMesh::default() },
        #[cfg(feature = "alembic")]
        "abc" => RawMesh { mesh: super::abc::read_mesh(&source)?, ..RawMesh::default() },
        #[cfg(feature = "usd")]
        "usd" | "usda" | "usdc" | "usdz" => {
            let (mesh, rig, declared, notes) = super::usd::read_mesh(&source)?;
            RawMesh { mesh, declared, rig, notes }
        }
        #[cfg(feature = "gltf")]
        "gltf" | "glb" => {
            let (mesh, rig, notes) = gltf::read(&source)?;
            RawMesh { mesh, declared: Choice::METRES, rig, notes }
        }
        _ => {
            let meshes = formats::listed(formats::MESHES, "or");
            return Err(source.problem(At::File, format!("a head is an {meshes} file")));
        }
    };
    if raw.mesh.triangles.is_empty() {
        return Err(source.problem(At::File, "the file holds no triangles"));
    }
    if raw.mesh.positions.iter().any(|p| !p.is_finite()) {
        return Err(source.problem(At::File, "a vertex position is not finite"));
    }
    if raw.mesh.normals.len() != raw.mesh.positions.len() {
        raw.mesh.compute_normals();
        if let Some(rig) = &mut raw.rig {
            rig.take_normals(&raw.mesh);
        }
    }
    Ok(raw)
}

/// Faces of `counts` corners each as fans of triangles: counterclockwise as they are listed, or `turned`. `corners`
/// count `points` from 0, which begin at `base` in the mesh.
#[cfg(any(feature = "alembic", feature = "usd"))]
pub(super) fn fan(
    counts: &[i64],
    corners: &[i64],
    points: usize,
    base: u32,
    turned: bool,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    if let Some(index) = corners.iter().find(|index| !(0..points as i64).contains(index)) {
        return Err(format!("vertex {index} does not exist, there are {points}"));
    }
    let mut rest = corners;
    for count in counts {
        let split = usize::try_from(*count).ok().and_then(|count| rest.split_at_checked(count));
        let Some((face, more)) = split else {
            return Err(format!("a face of {count} corners where {} are left", rest.len()));
        };
        rest = more;
        // Below 2^28 in all.
        let corner = |k: usize| base + face[k] as u32;
        triangles.extend((2..face.len()).map(|k| match turned {
            false => [corner(0), corner(k - 1), corner(k)],
            true => [corner(0), corner(k), corner(k - 1)],
        }));
    }
    Ok(())
}

/// The same error as one of a file.
fn at_file(path: &Path, error: Error) -> Error {
    Error::File { path: path.to_path_buf(), at: At::File, problem: error.to_string() }
}

fn append(all: &mut TriMesh, part: TriMesh) {
    let base = all.positions.len() as u32;
    let [own, more] = [&*all, &part].map(|mesh| mesh.positions.len());
    all.paint = Paint::join(all.paint.as_deref(), own, part.paint.as_deref(), more).map(Arc::new);
    if !all.colors.is_empty() || !part.colors.is_empty() {
        all.colors.resize(all.positions.len(), PLAIN);
        all.colors.extend(part.colors);
    }
    all.positions.extend(part.positions);
    all.normals.extend(part.normals);
    all.triangles.extend(part.triangles.iter().map(|t| t.map(|i| i + base)));
    if !all.colors.is_empty() {
        all.colors.resize(all.positions.len(), PLAIN);
    }
}

#[cfg(test)]
mod tests;
