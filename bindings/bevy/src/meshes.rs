//! Meshes of Bevy's as the library has them, and back.

use bevy::{
    asset::RenderAssetUsages,
    color::{ColorToComponents, LinearRgba},
    mesh::{Indices, PrimitiveTopology, VertexAttributeValues},
    prelude::*,
};
use tresses::groom::TriMesh;

/// The triangles of a mesh, to grow hair on or to push it; nothing where it is no list of triangles with positions and
/// normals that the main world still has.
pub fn tri_mesh(mesh: &Mesh) -> Option<TriMesh> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return None;
    }
    let vectors = |attribute| match mesh.try_attribute_option(attribute) {
        Ok(Some(VertexAttributeValues::Float32x3(all))) => {
            Some(all.iter().map(|v| Vec3::from_array(*v)).collect::<Vec<_>>())
        }
        _ => None,
    };
    let (positions, normals) = (vectors(Mesh::ATTRIBUTE_POSITION)?, vectors(Mesh::ATTRIBUTE_NORMAL)?);
    let corners: Vec<u32> = match mesh.try_indices_option() {
        Ok(Some(indices)) => indices.iter().map(|i| u32::try_from(i).ok()).collect::<Option<_>>()?,
        Ok(None) => (0..u32::try_from(positions.len()).ok()?).collect(),
        Err(_) => return None,
    };
    Some(TriMesh { positions, normals, triangles: corners.as_chunks::<3>().0.to_vec(), ..TriMesh::default() })
}

/// The mesh for Bevy to draw.
pub(crate) fn mesh(TriMesh { positions, normals, colors, triangles, .. }: &TriMesh) -> Mesh {
    let all = |vectors: &[Vec3]| vectors.iter().map(Vec3::to_array).collect::<Vec<_>>();
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, all(positions))
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, all(normals))
        .with_inserted_indices(Indices::U32(triangles.as_flattened().to_vec()));
    if !colors.is_empty() {
        let linear = |color: &Vec3| LinearRgba::from_vec3(*color).to_f32_array();
        mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors.iter().map(linear).collect::<Vec<_>>());
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_the_same_after_both_ways() {
        let cube = tri_mesh(&Cuboid::from_length(1.0).into()).expect("a cube has triangles");
        assert_eq!((cube.positions.len(), cube.triangles.len()), (24, 12));
        assert_eq!(tri_mesh(&mesh(&cube)), Some(cube.clone()));
        let other = TriMesh { triangles: cube.triangles[1..].to_vec(), ..cube.clone() };
        assert_ne!(tri_mesh(&mesh(&other)), Some(cube), "the comparer sees no difference");
        let flat = mesh(&other).with_removed_attribute(Mesh::ATTRIBUTE_NORMAL);
        assert_eq!(tri_mesh(&flat), None);
        assert_eq!(tri_mesh(&Segment3d::new(Vec3::ZERO, Vec3::X).into()), None, "a line has none");
    }
}
