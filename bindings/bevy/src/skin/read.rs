//! Meshes of Bevy's that bend, as the library has them.

use super::{HairSkin, OnSkin, Skin, Stance};
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
    rig::{Bind, Delta, Joint, Node, Target},
};

/// What is looked up in the main world.
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
    places: Extract<'w, 's, Query<'static, 'static, &'static GlobalTransform>>,
    parents: Extract<'w, 's, Query<'static, 'static, &'static ChildOf>>,
    names: Extract<'w, 's, Query<'static, 'static, &'static Name>>,
    weights: Extract<'w, 's, Query<'static, 'static, &'static MorphWeights>>,
    meshes: Extract<'w, 's, Res<'static, Assets<Mesh>>>,
    binds: Extract<'w, 's, Res<'static, Assets<SkinnedMeshInverseBindposes>>>,
}

/// What a skin was read for: it is read again when this changes.
#[derive(Debug, PartialEq)]
struct Key {
    on: HairSkin,
    mesh: AssetId<Mesh>,
    binds: Option<AssetId<SkinnedMeshInverseBindposes>>,
    joints: Vec<Entity>,
    /// The place of the joint that carries the hair.
    carrier: Option<usize>,
}

/// What was read, by the entities of the hair.
#[derive(Debug, Default)]
pub(crate) struct Reading(EntityHashMap<(Key, Option<Arc<Skin>>)>);

impl Reading {
    /// Forgets hair that is gone.
    pub fn keep(&mut self, is_there: impl Fn(Entity) -> bool) {
        self.0.retain(|entity, _| is_there(*entity));
    }
}

impl SkinQueries<'_, '_> {
    /// The skin of the hair of an `entity` that is at `place`, read before or now; or why there can be none.
    pub fn find(
        &self,
        reading: &mut Reading,
        entity: Entity,
        on: &HairSkin,
        place: Mat4,
    ) -> Result<OnSkin, String> {
        let Ok((mesh, own, skinned, morph)) = self.bodies.get(on.mesh) else {
            return Err("hair is to be on an entity that has no mesh".into());
        };
        if !(on.reach.is_finite() && on.at.is_none_or(|at| at.is_finite())) {
            return Err("hair is on a skin at a place that is no number".into());
        }
        let (Some(asset), binds) =
            (self.meshes.get(&mesh.0), skinned.map(|skinned| self.binds.get(&skinned.inverse_bindposes)))
        else {
            return Ok(OnSkin::Awaited);
        };
        if binds.is_some_and(|binds| binds.is_none()) {
            return Ok(OnSkin::Awaited);
        }
        let alone = [on.mesh];
        let joints: &[Entity] = skinned.map_or(&alone, |skinned| &skinned.joints);
        let stance = Stance {
            joints: match skinned {
                Some(_) => joints.iter().map(|joint| self.place(*joint)).collect(),
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
        let carrier = self.above(entity).find_map(|up| place_of(joints, up));
        let of_binds = skinned.map(|skinned| skinned.inverse_bindposes.id());
        let is = |key: &Key| {
            (key.on, key.mesh, key.binds, key.carrier) == (*on, mesh.0.id(), of_binds, carrier)
                && key.joints == joints
        };
        let known = reading.0.get(&entity).filter(|(key, _)| is(key)).map(|(_, skin)| skin.clone());
        let skin = match known {
            Some(skin) => skin,
            None => {
                let identity = [Mat4::IDENTITY];
                let binds = binds.flatten().map_or(&identity[..], |binds| binds);
                if binds.len() < joints.len() || joints.is_empty() {
                    return Err(format!(
                        "hair is on {} joints with {} bind poses",
                        joints.len(),
                        binds.len()
                    ));
                }
                let to_mesh = on.at.unwrap_or_else(|| {
                    carrier
                        .map_or(Mat4::IDENTITY, |i| binds[i].inverse() * stance.joints[i].inverse() * place)
                });
                if !to_mesh.is_finite() || to_mesh.determinant().abs() < 1e-12 {
                    // It may grow from nothing: it is tried again.
                    return Err("a joint above hair is flattened".into());
                }
                let key =
                    Key { on: *on, mesh: mesh.0.id(), binds: of_binds, joints: joints.to_vec(), carrier };
                match self.read(on, asset, (joints, binds), to_mesh) {
                    Ok(skin) => {
                        let skin = Some(Arc::new(skin));
                        reading.0.insert(entity, (key, skin.clone()));
                        skin
                    }
                    Err(problem) => {
                        reading.0.insert(entity, (key, None));
                        return Err(format!("hair cannot be on a mesh: {problem}"));
                    }
                }
            }
        };
        // What could not be read was said when it was tried.
        Ok(skin.map_or(OnSkin::Awaited, |skin| OnSkin::Yes(skin, stance)))
    }

    fn place(&self, entity: Entity) -> Mat4 {
        self.places.get(entity).map_or(Mat4::IDENTITY, GlobalTransform::to_matrix)
    }

    fn read(
        &self,
        on: &HairSkin,
        asset: &Mesh,
        (joints, binds): (&[Entity], &[Mat4]),
        to_mesh: Mat4,
    ) -> Result<Skin, String> {
        // Parents before their children, as a rig has them.
        let parent = |joint: Entity| self.above(joint).skip(1).find_map(|up| place_of(joints, up));
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
            .ok_or("it is no list of triangles with positions and normals that the main world has")?;
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
        Ok(Skin { entity: on.mesh, rig, mesh, order, to_mesh, reach: on.reach })
    }

    /// An entity and all that it is in.
    fn above(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        std::iter::successors(Some(entity), |at| self.parents.get(*at).ok().map(ChildOf::parent))
    }
}

fn place_of(joints: &[Entity], entity: Entity) -> Option<usize> {
    joints.iter().position(|joint| *joint == entity)
}

/// What each vertex follows; `numbers` are those of the rig's joints in Bevy's order.
fn bound(asset: &Mesh, mesh: &TriMesh, numbers: &[u16]) -> Result<Vec<Bind>, String> {
    let all = mesh.positions.iter().zip(&mesh.normals);
    let attribute = |id| asset.try_attribute_option(id).ok().flatten();
    let joints = match attribute(Mesh::ATTRIBUTE_JOINT_INDEX) {
        Some(VertexAttributeValues::Uint16x4(all)) => Some(all),
        Some(_) => return Err("its joints are not of the usual format".into()),
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
        Some(_) => return Err("its weights are not of a usual format".into()),
        None => None,
    };
    let Some((joints, weights)) = joints.zip(weights) else {
        return Ok(all.map(|(p, n)| Bind::rigid(*p, *n, 0)).collect());
    };
    let bind = |((p, n), (four, shares)): ((&Vec3, &Vec3), (&[u16; 4], [f32; 4]))| {
        let mut bind = Bind { position: *p, normal: *n, joints: [0; 8], weights: [0.0; 8] };
        let sum: f32 = shares.iter().sum();
        if sum <= 0.0 {
            return Ok(Bind::rigid(*p, *n, 0));
        }
        for (i, (joint, share)) in four.iter().zip(shares).enumerate().filter(|(_, (_, share))| *share > 0.0)
        {
            let Some(number) = numbers.get(usize::from(*joint)) else {
                return Err(format!("a vertex follows joint {joint} of {}", numbers.len()));
            };
            (bind.joints[i], bind.weights[i]) = (*number, share / sum);
        }
        Ok(bind)
    };
    if joints.len() != mesh.positions.len() || weights.len() != joints.len() {
        return Err("it has not a joint and a weight for each vertex".into());
    }
    all.zip(joints.iter().zip(weights)).map(bind).collect()
}

/// Shapes, of displacements that follow each other target by target.
fn targets(all: &[MorphAttributes], vertices: usize) -> Vec<Target> {
    let target = |(i, of): (usize, &[MorphAttributes])| {
        let moved = of.iter().enumerate().filter(|(_, d)| d.position != Vec3::ZERO || d.normal != Vec3::ZERO);
        let delta = |(vertex, d): (usize, &MorphAttributes)| Delta {
            vertex: vertex as u32,
            position: d.position,
            normal: d.normal,
        };
        Target { name: i.to_string(), deltas: moved.map(delta).collect() }
    };
    all.chunks_exact(vertices.max(1)).enumerate().map(target).collect()
}
