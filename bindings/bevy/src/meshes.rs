//! Converts meshes between Bevy and the library.

use bevy::{
    asset::RenderAssetUsages,
    color::{ColorToComponents, LinearRgba},
    mesh::{Indices, PrimitiveTopology, VertexAttributeValues},
    prelude::*,
};
use tresses::groom::{
    Rig, TriMesh,
    rig::{Bind, Joint},
};

/// Converts a mesh to grow hair on it or to use it as a collider. Returns `None` unless it is a triangle list with
/// positions and normals that the main world still has.
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
    if normals.len() != positions.len() || corners.iter().any(|i| *i as usize >= positions.len()) {
        return None;
    }
    Some(TriMesh { positions, normals, triangles: corners.as_chunks::<3>().0.to_vec(), ..TriMesh::default() })
}

/// Converts a mesh for Bevy to draw.
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

/// Returns the mesh of a skinned character for a [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), and the inverse
/// bind poses of the rig's joints in order.
///
/// The mesh has the vertices of `of` at rest, in the groom's space, which is the bind pose. An entity for a joint is at
/// rest at the transform of the joint's node in the rig, times [`Rig::to_groom`]. Of more than four joints per vertex,
/// the four strongest are kept. Morph targets and animations are not converted.
pub fn skinned_mesh(of: &TriMesh, rig: &Rig) -> (Mesh, Vec<Mat4>) {
    let strongest = |bind: &Bind| {
        let mut all: Vec<(u16, f32)> = bind.joints.into_iter().zip(bind.weights).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let sum: f32 = all[..4].iter().map(|(_, weight)| weight).sum();
        let four: [(u16, f32); 4] = std::array::from_fn(|i| (all[i].0, all[i].1 / sum.max(1e-6)));
        four
    };
    let four: Vec<_> = rig.vertices.iter().map(strongest).collect();
    let joints = four.iter().map(|four| four.map(|(joint, _)| joint)).collect();
    let weights: Vec<[f32; 4]> = four.iter().map(|four| four.map(|(_, weight)| weight)).collect();
    let mesh = mesh(of)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    let rest = rig.rest_pose().globals;
    let bind = |joint: &Joint| (rig.to_groom * rest[joint.node as usize]).inverse();
    (mesh, rig.joints.iter().map(bind).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::groom::mannequin;

    #[test]
    fn mesh_round_trips() {
        let cube = tri_mesh(&Cuboid::from_length(1.0).into()).expect("a cube has triangles");
        assert_eq!((cube.positions.len(), cube.triangles.len()), (24, 12));
        assert_eq!(tri_mesh(&mesh(&cube)), Some(cube.clone()));
        let other = TriMesh { triangles: cube.triangles[1..].to_vec(), ..cube.clone() };
        assert_ne!(tri_mesh(&mesh(&other)), Some(cube.clone()), "the comparer sees no difference");
        let torn = mesh(&TriMesh { triangles: vec![[0, 1, 99]], ..cube });
        assert_eq!(tri_mesh(&torn), None, "a corner is none of its vertices");
        let flat = mesh(&other).with_removed_attribute(Mesh::ATTRIBUTE_NORMAL);
        assert_eq!(tri_mesh(&flat), None);
        assert_eq!(tri_mesh(&Segment3d::new(Vec3::ZERO, Vec3::X).into()), None, "a line has none");
    }

    #[test]
    fn skinned_mesh_keeps_four_joints_and_its_rest_pose() {
        let bust = mannequin::mesh(40);
        let mut rig = mannequin::rig::rig(&bust);
        rig.vertices[0].weights = [0.05, 0.3, 0.25, 0.2, 0.1, 0.06, 0.04, 0.0];
        rig.vertices[0].joints = [0, 1, 2, 0, 1, 2, 0, 1];
        let (mesh, binds) = skinned_mesh(&bust, &rig);
        let Some(VertexAttributeValues::Float32x4(weights)) = mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT)
        else {
            panic!("it has weights")
        };
        assert!(weights.iter().all(|four| (four.iter().sum::<f32>() - 1.0).abs() < 1e-5));
        assert!((weights[0][0] - 0.3 / 0.85).abs() < 1e-6 && (weights[0][3] - 0.1 / 0.85).abs() < 1e-6);
        for (bind, global) in binds.iter().zip(rig.rest_pose().globals) {
            assert!((global * *bind).abs_diff_eq(Mat4::IDENTITY, 1e-5));
        }
    }
}
