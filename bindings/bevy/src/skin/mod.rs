//! Bevy's skinned meshes, converted to a mesh and a rig of the library, and the transforms of their joints in each
//! frame.
//!
//! ```text
//! main world    Mesh, SkinnedMesh ─► Skin (once)        GlobalTransform of joints, weights ─► JointTransforms (each
//! frame)
//! a task        Skin ─► CharacterParts ─► Character
//! render world  JointTransforms ─► BodyPose ─► Character
//! ```
//!
//! Bevy deforms vertices while drawing and does not store them, so the library deforms its own copy of the mesh with
//! the same joints. A vertex `v` is at `G_j · I_j · v` in the world, where `G_j` is the transform of joint `j` and
//! `I_j` its inverse bind pose. The rest pose in the groom's space is the vertices transformed by `T⁻¹`, where `T` is
//! [`Skin::to_mesh`]. Hair follows the joint that carries most of its roots: from `T⁻¹ · I_j⁻¹` at rest to `G_j` now.

mod read;

pub(crate) use read::{SkinCache, SkinQueries};

use bevy::prelude::*;
use std::sync::Arc;
use tresses::{
    BodyPose, Pose,
    groom::{Rig, RigPose, TriMesh, rig::anatomy::Anatomy},
};

/// Attaches hair to a skinned mesh of Bevy. Add it next to [`Hair3d`](crate::Hair3d).
///
/// The body is an entity with a [`Mesh3d`] that is deformed by joints
/// ([`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh)), morph targets, or both. Each root follows the skin at its
/// position. The deformed mesh replaces the groom's own head for collisions and shadows, part by part.
///
/// Hair below one of the joints in the hierarchy rests where that joint is in the bind pose. Other hair rests in the
/// space of the mesh's vertices, as a groom made for that mesh; its own transform is then ignored. If neither is right,
/// set [`at`](Self::at).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct HairSkin {
    /// The entity with the mesh.
    pub mesh: Entity,
    /// Transform from the groom's space to the space of the mesh's vertices, in the bind pose.
    pub at: Option<Mat4>,
    /// Largest distance of a root from the skin at rest, meters. Hair with a farther root is rejected.
    pub max_root_distance: f32,
}

impl HairSkin {
    /// Attaches hair to the skin of an entity, with roots at most a centimeter from it.
    pub fn new(mesh: Entity) -> Self {
        Self { mesh, at: None, max_root_distance: 0.01 }
    }
}

/// A skinned mesh in the library's form, created once.
#[derive(Debug)]
pub(crate) struct Skin {
    /// The entity with the mesh.
    pub entity: Entity,
    /// Joints and morph targets, with one node per joint.
    pub rig: Rig,
    /// Mesh at rest, in the groom's space, meters.
    pub mesh: TriMesh,
    /// Index of each of the rig's joints among Bevy's joints.
    pub order: Vec<usize>,
    /// Transform from the groom's space at rest to the space of the vertices.
    pub to_mesh: Mat4,
    /// [`HairSkin::max_root_distance`].
    pub max_root_distance: f32,
}

/// Joint transforms and morph weights of a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointTransforms {
    /// Transforms of Bevy's joints in the world.
    pub joints: Vec<Mat4>,
    /// Weights of the morph targets.
    pub weights: Vec<f32>,
}

/// State of the skin that hair is attached to.
#[derive(Clone, Debug, Default)]
pub(crate) enum SkinState {
    /// Hair is not on a skin.
    #[default]
    Off,
    /// The mesh is not loaded yet.
    Awaited,
    /// The mesh, and its joints in this frame.
    Loaded(Arc<Skin>, JointTransforms),
}

impl SkinState {
    /// Returns the skin, if it is loaded.
    pub fn skin(&self) -> Option<&Arc<Skin>> {
        match self {
            Self::Loaded(skin, _) => Some(skin),
            _ => None,
        }
    }
}

impl Skin {
    /// Returns the pose of the joint that hair follows, from its rest pose in the groom's space to the world, and the
    /// pose of the whole body relative to it.
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
