//! Skinned meshes of Bevy's as a mesh and a rig of the library's, and the transforms of their joints in each frame.
//!
//! ```text
//! main world    Mesh, SkinnedMesh ─► Skin (once)        GlobalTransform of joints, weights ─► JointTransforms (each frame)
//! a task        Skin ─► CharacterParts ─► Character
//! render world  JointTransforms ─► BodyPose ─► Character
//! ```
//!
//! Bevy deforms vertices where it draws them and keeps none, so the library deforms its own copy of the mesh with the same
//! joints. A vertex `v` is at `G_j · I_j · v` in the world, with the joint's transform and its inverse bind pose. The
//! groom's space at rest is that of the vertices after `T⁻¹` ([`Skin::to_mesh`]); hair goes with the joint that carries
//! most of its roots, from `T⁻¹ · I_j⁻¹` at rest to `G_j` now.

mod read;

pub(crate) use read::{SkinCache, SkinQueries};

use bevy::prelude::*;
use std::sync::Arc;
use tresses::{
    Pose,
    character::BodyPose,
    groom::{Rig, RigPose, TriMesh, rig::anatomy::Anatomy},
};

/// Roots of hair on the skin of a body that Bevy bends: beside [`Hair3d`](crate::Hair3d).
///
/// The body is an entity with a [`Mesh3d`], which joints ([`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh)), morph
/// targets or both bend. Each root goes with the skin at its place; what hair collides with, and what shades it, is this
/// mesh as it is bent, part by part, in place of the groom's own head.
///
/// Hair that is a child of one of the joints, or farther below it, rests where that joint has it in the bind pose. Hair
/// elsewhere rests in the space of the mesh's vertices, as a groom that was made on that mesh; where its entity is plays no
/// part then. `HairSkin::at` says it where neither holds.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct HairSkin {
    /// The entity with the mesh.
    pub mesh: Entity,
    /// From the groom's space to that of the mesh's vertices, in the bind pose.
    pub at: Option<Mat4>,
    /// No root may be farther from the skin at rest, metres.
    pub reach: f32,
}

impl HairSkin {
    /// On the skin of an entity, at most a centimetre from it.
    pub fn new(mesh: Entity) -> Self {
        Self { mesh, at: None, reach: 0.01 }
    }
}

/// A skinned mesh, for the library: made once.
#[derive(Debug)]
pub(crate) struct Skin {
    /// The entity with the mesh.
    pub entity: Entity,
    /// Its joints and morph targets; a node for each joint.
    pub rig: Rig,
    /// At rest, in the groom's space, metres.
    pub mesh: TriMesh,
    /// The place among Bevy's joints of each of the rig's.
    pub order: Vec<usize>,
    /// From the groom's space at rest to that of the vertices.
    pub to_mesh: Mat4,
    /// [`HairSkin::reach`].
    pub reach: f32,
}

/// What deforms a skinned mesh in a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointTransforms {
    /// From each of Bevy's joints to the world.
    pub joints: Vec<Mat4>,
    /// The weight of each morph target.
    pub weights: Vec<f32>,
}

/// The skin that hair is on.
#[derive(Clone, Debug, Default)]
pub(crate) enum SkinState {
    /// None.
    #[default]
    Off,
    /// Its mesh is not loaded yet.
    Awaited,
    /// Its mesh, and the joints in this frame.
    Loaded(Arc<Skin>, JointTransforms),
}

impl SkinState {
    /// The skin, where it is loaded.
    pub fn skin(&self) -> Option<&Arc<Skin>> {
        match self {
            Self::Loaded(skin, _) => Some(skin),
            _ => None,
        }
    }
}

impl Skin {
    /// The pose of the joint that hair goes with, from where it rests in the groom's space to the world, and that of the
    /// whole body relative to it.
    pub fn pose(&self, anatomy: &Anatomy, at: &JointTransforms) -> (Pose, BodyPose) {
        let joint = |number: usize| at.joints.get(self.order[number]).copied().unwrap_or_default();
        let node = |node: u32| {
            let rest = (self.rig.joints[node as usize].inverse_bind * self.to_mesh).inverse();
            Pose::between(&rest, &joint(node as usize))
        };
        let head = node(anatomy.head.node);
        let to_head = head.inverse();
        let palette = self.rig.joints.iter().enumerate();
        let palette = palette.map(|(i, it)| to_head.matrix() * joint(i) * it.inverse_bind).collect();
        let mut weights = at.weights.clone();
        weights.resize(self.rig.targets.len(), 0.0);
        let rig = RigPose { palette, weights, ..Default::default() };
        let parts = anatomy.solids().map(|part| to_head.after(&node(part.node))).collect();
        (head, BodyPose { rig, head: Pose::IDENTITY, parts })
    }
}
