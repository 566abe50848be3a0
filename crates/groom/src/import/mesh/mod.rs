//! Imports triangle meshes from files.

pub use crate::formats::raw::RawMesh;

use std::{path::Path, sync::Arc};

use crate::{
    TriMesh,
    error::{At, Error, Result},
    formats::{
        self, FileFormat,
        faces::PLAIN,
        source::{FileBytes, Files, Source},
    },
    mesh::Paint,
    rig::Rig,
};

/// Maximum bytes of the images of all files together.
#[cfg(feature = "textures")]
const MAX_IMAGE_BYTES: u64 = 1 << 30;

/// Reads one mesh, in the file's own unit and axes; [`crate::orient::head`] orients it. Missing normals are computed,
/// weighted by angle. Vertex colors are the materials' base colors.
pub fn read(path: &Path) -> Result<RawMesh> {
    parse(Files::Disk, path, &Files::Disk.load(path)?)
}

/// [`read`] for files in memory: the mesh `path` and the files that it refers to are among `files`.
///
/// # Errors
/// The errors of [`read`], and [`Error::File`] if a file that the mesh refers to is missing.
pub fn read_given(files: &[FileBytes<'_>], path: &Path) -> Result<RawMesh> {
    let files = Files::Given(files);
    parse(files, path, &files.load(path)?)
}

/// Reads several meshes that share one unit and one set of axes, and joins them. If any of them has a rig, the result
/// has one: meshes without a rig follow a node of their own, and blend shapes and animations of the same name are
/// merged.
pub fn read_all<P: AsRef<Path>>(paths: &[P]) -> Result<RawMesh> {
    read_from(Files::Disk, paths)
}

/// [`read_all`] from any source of files.
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
                all.lights.extend(part.lights);
                all.notes.extend(part.notes);
                all.declared = all.declared.shared(part.declared);
                all
            }
        });
    }
    #[cfg(feature = "textures")]
    if let Some(paint) = all.as_mut().and_then(|all| all.mesh.paint.as_mut()) {
        // The images of several files need one size, too.
        Arc::make_mut(paint).level(MAX_IMAGE_BYTES);
    }
    all.ok_or_else(|| Error::Unusable("no head mesh is given".into()))
}

/// Reads a mesh from its bytes. `path` decides the format, and where among `files` materials and buffers are found.
fn parse(files: Files<'_>, path: &Path, bytes: &[u8]) -> Result<RawMesh> {
    let source = Source { path, bytes, files, lenient: false };
    if bytes.is_empty() {
        return Err(source.problem(At::Byte(0), "the file is empty"));
    }
    let read = FileFormat::of(path).and_then(|format| format.read_mesh);
    let mut raw = read.ok_or_else(|| FileFormat::unread(path, "a head", formats::MESHES))?(&source)?;
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

/// Converts an error to one of a file.
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
