//! Reads all meshes of a file as one head mesh.

use glam::{DMat4, DVec3, Vec3};

use super::{
    Archive,
    tree::{Schema, Tree},
};
use crate::{
    TriMesh,
    error::{At, Result},
    formats::{faces::fan, raw::RawMesh, source::Source},
};

/// Reads all meshes of a file at the sample nearest to time 0. Normals are not read; the importer computes them.
pub(crate) fn read(source: &Source) -> Result<RawMesh> {
    let archive = Archive::open(source)?;
    let tree = Tree::read(&archive)?;
    let matrices = tree.matrices(&archive, 0.0)?;
    let mut mesh = TriMesh::default();
    for object in tree.objects.iter().filter(|object| object.schema == Schema::Mesh) {
        let property = |name: &str| match object.shape.property(&archive, name)? {
            Some(property) => Ok(property),
            None => Err(source.problem(At::File, format!("the mesh {} has no {name}", object.names[0]))),
        };
        let (points, counts, corners) = (property("P")?, property(".faceCounts")?, property(".faceIndices")?);
        let matrix = Tree::of(object, &matrices);
        let transform = |p: &[f32; 3]| match matrix == DMat4::IDENTITY {
            true => Vec3::from(*p),
            false => matrix.transform_point3(DVec3::from(Vec3::from(*p))).as_vec3(),
        };
        let base = mesh.positions.len() as u64;
        archive.spend(points.count(&archive)? + corners.count(&archive)?, 0)?;
        mesh.positions.extend(points.floats(&archive, 0.0)?.as_chunks().0.iter().map(transform));
        source.check_vertices(0, mesh.positions.len() as u64)?;
        let have = mesh.positions.len() as u64 - base;
        let (counts, indices) = (counts.integers(&archive, 0.0)?, corners.integers(&archive, 0.0)?);
        // Alembic's faces are clockwise. `base` is below 2^28.
        let reverse_winding = matrix.determinant() >= 0.0;
        fan(&counts, &indices, have as usize, base as u32, reverse_winding, &mut mesh.triangles)
            .map_err(|problem| source.problem(corners.at(), problem))?;
    }
    Ok(RawMesh { mesh, ..RawMesh::default() })
}
