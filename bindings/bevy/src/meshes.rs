//! Meshes of Bevy's as the library has them, and back.

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

/// The triangles of a mesh, to grow hair on or to push it; nothing where it is no list of triangles between vertices with
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

/// The mesh of a body that joints bend, for Bevy to draw with a
/// [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), and the inverse bind poses of its joints, in the order of the rig's.
/// Its vertices are those of `mesh`, the body at rest in the groom's space, and that is its bind pose: an entity that stands
/// for a joint is at rest where the rig has the joint's node, times [`Rig::to_groom`]. Of what more than four joints carry
/// the four strongest are left; shapes and animations stay the rig's.
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
    fn a_mesh_is_the_same_after_both_ways() {
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
    fn a_body_keeps_its_four_strongest_joints_and_rests_where_it_is() {
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
