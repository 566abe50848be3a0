//! Skin that Bevy bends: its mesh as a body of the library's, and where its joints are in each frame.
//!
//! ```text
//! main world    Mesh, SkinnedMesh ─► Skin (once)          GlobalTransform of joints, weights ─► Stance (each frame)
//! a task        Skin ─► Anatomy: the part of each joint, its field or its capsule
//! render world  Stance ─► palette ─► skinning::Skinning ─► vertices ─► roots, fields, shadows
//! ```
//!
//! Bevy bends vertices where it draws them and keeps none, so the library bends its own copy of the mesh with the same
//! joints. A vertex `v` is at `G_j · I_j · v` in the world, with the joint's transform and its inverse bind pose. The
//! groom's space at rest is that of the vertices after `T⁻¹` ([`Skin::to_mesh`]); hair goes with the joint that carries
//! most of its roots, from `T⁻¹ · I_j⁻¹` at rest to `G_j` now.

mod read;

pub(crate) use read::{Reading, SkinQueries};

use bevy::prelude::*;
use std::sync::Arc;
use tresses::{
    Pose,
    groom::{Rig, RigPose, TriMesh},
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

/// A mesh that bends, for the library: made once.
#[derive(Debug)]
pub(crate) struct Skin {
    /// The entity with the mesh.
    pub entity: Entity,
    /// Its joints and shapes; a node for each joint.
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

/// Where what bends it is in a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stance {
    /// Of each of Bevy's joints, to the world.
    pub joints: Vec<Mat4>,
    /// Of each morph target.
    pub weights: Vec<f32>,
}

/// The skin that hair is on.
#[derive(Clone, Debug, Default)]
pub(crate) enum OnSkin {
    /// It is on none.
    #[default]
    No,
    /// The mesh is not there yet.
    Awaited,
    /// There.
    Yes(Arc<Skin>, Stance),
}

impl OnSkin {
    /// The skin, where it is there.
    pub fn skin(&self) -> Option<&Arc<Skin>> {
        match self {
            Self::Yes(skin, _) => Some(skin),
            _ => None,
        }
    }
}

impl Skin {
    /// The pose of what goes with a node: from where it rests in the groom's space to the world.
    pub fn node(&self, node: u32, stance: &Stance) -> Pose {
        let joint = &self.rig.joints[node as usize];
        let rest = (joint.inverse_bind * self.to_mesh).inverse();
        Pose::between(&rest, &self.joint(node as usize, stance))
    }

    /// The pose of all vertices, relative to `head`.
    pub fn pose(&self, head: &Pose, stance: &Stance) -> RigPose {
        let to_head = head.inverse().matrix();
        let palette = self.rig.joints.iter().enumerate();
        let palette =
            palette.map(|(i, joint)| to_head * self.joint(i, stance) * joint.inverse_bind).collect();
        let mut weights = stance.weights.clone();
        weights.resize(self.rig.targets.len(), 0.0);
        RigPose { palette, weights, ..Default::default() }
    }

    /// The transform of a joint of the rig, which has a node of the same number.
    fn joint(&self, number: usize, stance: &Stance) -> Mat4 {
        stance.joints.get(self.order[number]).copied().unwrap_or_default()
    }
}
