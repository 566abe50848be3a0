//! Reads skinned meshes from the main world.

use super::{HairSkin, JointTransforms, Skin, SkinState};
use crate::meshes::tri_mesh;
use bevy::{
    ecs::{entity::EntityHashMap, system::SystemParam},
    mesh::{
        VertexAttributeValues,
        morph::{MeshMorphWeights, MorphAttributes, MorphWeights},
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    render::Extract,
};
use std::sync::Arc;
use tresses::groom::{
    Rig, TriMesh,
    rig::{Bind, Delta, Joint, MorphTarget, Node},
};

/// Meshes and joints of the main world.
#[derive(SystemParam)]
pub(crate) struct SkinQueries<'w, 's> {
    bodies: Extract<
        'w,
        's,
        Query<
            'static,
            'static,
            (
                &'static Mesh3d,
                &'static GlobalTransform,
                Option<&'static SkinnedMesh>,
                Option<&'static MeshMorphWeights>,
            ),
        >,
    >,
    global_transforms: Extract<'w, 's, Query<'static, 'static, &'static GlobalTransform>>,
    parents: Extract<'w, 's, Query<'static, 'static, &'static ChildOf>>,
    names: Extract<'w, 's, Query<'static, 'static, &'static Name>>,
    weights: Extract<'w, 's, Query<'static, 'static, &'static MorphWeights>>,
    meshes: Extract<'w, 's, Res<'static, Assets<Mesh>>>,
    binds: Extract<'w, 's, Res<'static, Assets<SkinnedMeshInverseBindposes>>>,
}

/// Inputs of a skin. The skin is read again when they change.
#[derive(Debug, PartialEq)]
struct SkinKey {
    on: HairSkin,
    mesh: AssetId<Mesh>,
    binds: Option<AssetId<SkinnedMeshInverseBindposes>>,
    joints: Vec<Entity>,
    /// Index of the joint that carries the hair.
    carrier: Option<usize>,
}

/// Skins by the entity of the hair; `None` for a skin that could not be read.
#[derive(Debug, Default)]
pub(crate) struct SkinCache(EntityHashMap<(SkinKey, Option<Arc<Skin>>)>);

impl SkinCache {
    /// Drops the skins of removed hair.
    pub fn keep(&mut self, exists: impl Fn(Entity) -> bool) {
        self.0.retain(|entity, _| exists(*entity));
    }
}

impl SkinQueries<'_, '_> {
    /// Returns the skin of hair on `entity` with `transform`, from the cache or by reading it.
    ///
    /// # Errors
    /// Returns why there is no skin.
    pub fn find(
        &self,
        cache: &mut SkinCache,
        entity: Entity,
        on: &HairSkin,
        transform: Mat4,
    ) -> Result<SkinState, String> {
        let Ok((mesh, own, skinned, morph)) = self.bodies.get(on.mesh) else {
            return Err("HairSkin::mesh is an entity without a mesh".into());
        };
        if !(on.max_root_distance.is_finite() && on.at.is_none_or(|at| at.is_finite())) {
            return Err("HairSkin::at or HairSkin::max_root_distance is not finite".into());
        }
        let (Some(asset), binds) =
            (self.meshes.get(&mesh.0), skinned.map(|skinned| self.binds.get(&skinned.inverse_bindposes)))
        else {
            return Ok(SkinState::Awaited);
        };
        if binds.is_some_and(|binds| binds.is_none()) {
            return Ok(SkinState::Awaited);
        }
        let single_joint = [on.mesh];
        let joints: &[Entity] = skinned.map_or(&single_joint, |skinned| &skinned.joints);
        let transforms = JointTransforms {
            joints: match skinned {
                Some(_) => joints.iter().map(|joint| self.transform(*joint)).collect(),
                None => vec![own.to_matrix()],
            },
            weights: match morph {
                Some(MeshMorphWeights::Value { weights }) => weights.clone(),
                Some(MeshMorphWeights::Reference(other)) => {
                    self.weights.get(*other).map(|weights| weights.weights().to_vec()).unwrap_or_default()
                }
                None => Vec::new(),
            },
        };
        let carrier = self.above(entity).find_map(|up| index_of(joints, up));
        let key = SkinKey {
            on: *on,
            mesh: mesh.0.id(),
            binds: skinned.map(|skinned| skinned.inverse_bindposes.id()),
            joints: joints.to_vec(),
            carrier,
        };
        let known = cache.0.get(&entity).filter(|(other, _)| *other == key);
        let skin = if let Some((_, skin)) = known {
            skin.clone()
        } else {
            let identity = [Mat4::IDENTITY];
            let binds = binds.flatten().map_or(&identity[..], |binds| binds);
            if binds.len() < joints.len() || joints.is_empty() {
                return Err(format!(
                    "the mesh of HairSkin has {} joints, but {} bind poses",
                    joints.len(),
                    binds.len()
                ));
            }
            let in_bind_pose = |i: usize| binds[i].inverse() * transforms.joints[i].inverse() * transform;
            let to_mesh = on.at.unwrap_or_else(|| carrier.map_or(Mat4::IDENTITY, in_bind_pose));
            if !to_mesh.is_finite() || to_mesh.determinant().abs() < 1e-12 {
                // The joint may grow from zero size, so do not cache the failure.
                return Err("a joint above the hair has zero scale".into());
            }
            let skin = self.read(on, asset, (joints, binds), to_mesh).map(Arc::new);
            cache.0.insert(entity, (key, skin.as_ref().ok().cloned()));
            Some(skin.map_err(|problem| format!("cannot attach hair to a mesh: {problem}"))?)
        };
        // The error of an unreadable mesh was reported when it was read.
        Ok(skin.map_or(SkinState::Awaited, |skin| SkinState::Loaded(skin, transforms)))
    }

    fn transform(&self, entity: Entity) -> Mat4 {
        self.global_transforms.get(entity).map_or(Mat4::IDENTITY, GlobalTransform::to_matrix)
    }

    fn read(
        &self,
        on: &HairSkin,
        asset: &Mesh,
        (joints, binds): (&[Entity], &[Mat4]),
        to_mesh: Mat4,
    ) -> Result<Skin, String> {
        // A rig lists parents before children.
        let parent = |joint: Entity| self.above(joint).skip(1).find_map(|up| index_of(joints, up));
        let depth = |joint: Entity| self.above(joint).filter(|up| joints.contains(up)).count();
        let mut order: Vec<usize> = (0..joints.len()).collect();
        order.sort_by_key(|i| (depth(joints[*i]), *i));
        let node_of = |bevys: usize| order.iter().position(|i| *i == bevys).unwrap_or_default();
        let node = |i: &usize| Node {
            name: self.names.get(joints[*i]).map(|name| name.to_string()).unwrap_or_default(),
            parent: parent(joints[*i]).map(|up| node_of(up) as u32),
            ..Default::default()
        };
        let nodes = order.iter().map(node).collect();
        let joint = |(node, i): (usize, &usize)| Joint { node: node as u32, inverse_bind: binds[*i] };
        let palette: Vec<Joint> = order.iter().enumerate().map(joint).collect();
        let mut mesh = tri_mesh(asset)
            .ok_or("it must be a triangle list with positions and normals, kept in the main world")?;
        let numbers: Vec<u16> = (0..joints.len()).map(|i| node_of(i) as u16).collect();
        let vertices = bound(asset, &mesh, &numbers)?;
        let targets = targets(asset.morph_targets().map_or(&[][..], |all| all), mesh.positions.len());
        let to_groom = to_mesh.inverse();
        let upright = to_mesh.transpose();
        for (p, n) in mesh.positions.iter_mut().zip(&mut mesh.normals) {
            *p = to_groom.transform_point3(*p);
            *n = upright.transform_vector3(*n).normalize_or(Vec3::Y);
        }
        let rig = Rig { nodes, joints: palette, vertices, targets, animations: Vec::new(), to_groom };
        Ok(Skin { entity: on.mesh, rig, mesh, order, to_mesh, max_root_distance: on.max_root_distance })
    }

    /// Returns an entity and its ancestors.
    fn above(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        std::iter::successors(Some(entity), |at| self.parents.get(*at).ok().map(ChildOf::parent))
    }
}

fn index_of(joints: &[Entity], entity: Entity) -> Option<usize> {
    joints.iter().position(|joint| *joint == entity)
}

/// Returns the joints and weights of each vertex. `numbers` maps Bevy's joints to the rig's.
fn bound(asset: &Mesh, mesh: &TriMesh, numbers: &[u16]) -> Result<Vec<Bind>, String> {
    let all = mesh.positions.iter().zip(&mesh.normals);
    let attribute = |id| asset.try_attribute_option(id).ok().flatten();
    let joints = match attribute(Mesh::ATTRIBUTE_JOINT_INDEX) {
        Some(VertexAttributeValues::Uint16x4(all)) => Some(all),
        Some(_) => return Err("its joint indices must be Uint16x4".into()),
        None => None,
    };
    let weights: Option<Vec<[f32; 4]>> = match attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT) {
        Some(VertexAttributeValues::Float32x4(all)) => Some(all.clone()),
        Some(VertexAttributeValues::Unorm16x4(all)) => {
            Some(all.iter().map(|four| four.map(|w| f32::from(w) / 65_535.0)).collect())
        }
        Some(VertexAttributeValues::Unorm8x4(all)) => {
            Some(all.iter().map(|four| four.map(|w| f32::from(w) / 255.0)).collect())
        }
        Some(_) => return Err("its joint weights must be Float32x4, Unorm16x4 or Unorm8x4".into()),
        None => None,
    };
    let Some((joints, weights)) = joints.zip(weights) else {
        return Ok(all.map(|(p, n)| Bind::rigid(*p, *n, 0)).collect());
    };
    let bind = |((p, n), (four, vertex_weights)): ((&Vec3, &Vec3), (&[u16; 4], [f32; 4]))| {
        let mut bind = Bind { position: *p, normal: *n, joints: [0; 8], weights: [0.0; 8] };
        let sum: f32 = vertex_weights.iter().sum();
        if sum <= 0.0 {
            return Ok(Bind::rigid(*p, *n, 0));
        }
        for (i, (joint, weight)) in
            four.iter().zip(vertex_weights).enumerate().filter(|(_, (_, weight))| *weight > 0.0)
        {
            let Some(number) = numbers.get(usize::from(*joint)) else {
                return Err(format!(
                    "a vertex refers to joint {joint}, but there are {} joints",
                    numbers.len()
                ));
            };
            (bind.joints[i], bind.weights[i]) = (*number, weight / sum);
        }
        Ok(bind)
    };
    if joints.len() != mesh.positions.len() || weights.len() != joints.len() {
        return Err("the numbers of joint indices and weights differ from the number of vertices".into());
    }
    all.zip(joints.iter().zip(weights)).map(bind).collect()
}

/// Splits Bevy's morph attributes into one morph target per run of `vertices` displacements.
fn targets(all: &[MorphAttributes], vertices: usize) -> Vec<MorphTarget> {
    let target = |(i, of): (usize, &[MorphAttributes])| {
        let displaced =
            of.iter().enumerate().filter(|(_, d)| d.position != Vec3::ZERO || d.normal != Vec3::ZERO);
        let delta = |(vertex, d): (usize, &MorphAttributes)| Delta {
            vertex: vertex as u32,
            position: d.position,
            normal: d.normal,
        };
        MorphTarget { name: i.to_string(), deltas: displaced.map(delta).collect() }
    };
    all.chunks_exact(vertices.max(1)).enumerate().map(target).collect()
}
