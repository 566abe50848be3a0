//! Meshes, for heads: all of a file as one.

use glam::{DMat4, DVec3, Vec3};

use super::{
    Archive,
    tree::{Schema, Tree},
};
use crate::{
    TriMesh,
    error::{At, Result},
    import::Source,
};

/// Reads all meshes of a file at their first sample. Normals are left to whoever needs them.
pub(in crate::import) fn read(source: &Source) -> Result<TriMesh> {
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
        let moved = |p: &[f32; 3]| match matrix == DMat4::IDENTITY {
            true => Vec3::from(*p),
            false => matrix.transform_point3(DVec3::from(Vec3::from(*p))).as_vec3(),
        };
        let base = mesh.positions.len() as u64;
        archive.spend(points.count(&archive)? + corners.count(&archive)?, 0)?;
        mesh.positions.extend(points.floats(&archive, 0.0)?.as_chunks().0.iter().map(moved));
        source.check_vertices(0, mesh.positions.len() as u64)?;
        let indices = corners.integers(&archive, 0.0)?;
        let have = mesh.positions.len() as u64 - base;
        if let Some(index) = indices.iter().find(|index| !(0..have as i64).contains(index)) {
            let problem = format!("vertex {index} does not exist, there are {have}");
            return Err(source.problem(corners.at(), problem));
        }
        let mut rest = indices.as_slice();
        for count in counts.integers(&archive, 0.0)? {
            let Some((face, more)) =
                usize::try_from(count).ok().and_then(|count| rest.split_at_checked(count))
            else {
                let problem = format!("a face of {count} corners where {} are left", rest.len());
                return Err(source.problem(counts.at(), problem));
            };
            rest = more;
            // Below 2^28 in all.
            let corner = |k: usize| (base + face[k] as u64) as u32;
            // Faces go round the other way here.
            let turned = matrix.determinant() < 0.0;
            mesh.triangles.extend((2..face.len()).map(|k| match turned {
                true => [corner(0), corner(k - 1), corner(k)],
                false => [corner(0), corner(k), corner(k - 1)],
            }));
        }
    }
    Ok(mesh)
}
