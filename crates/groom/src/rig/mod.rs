//! Bodies that bend: joints that vertices follow, shapes to blend, and motions over time.
//!
//! ```text
//! Rig ── pose(animation, time) ─► RigPose ── deform ─► TriMesh
//!  nodes, joints,                  globals, palette,    positions,
//!  targets, animations             weights              normals
//! ```
//!
//! A pose is small: one matrix per joint and one weight per shape. What is done to each vertex with it
//! ([`Rig::deform`]) needs nothing else, so a GPU does it as well.

pub mod anatomy;
mod animation;
mod deform;
mod join;
mod pose;

pub use animation::{Animation, Channel, Curve, Interpolation, Property};
pub use pose::RigPose;

use glam::{Mat4, Quat, Vec3};

/// The most palette entries a rig may have: what 16 bits count.
pub const MAX_JOINTS: usize = 1 << 16;
/// The most joints that one vertex follows.
pub const INFLUENCES: usize = 8;

/// A body that bends: a mesh whose vertices follow joints, with shapes to blend, and motions.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Rig {
    /// A parent stands before its children.
    pub nodes: Vec<Node>,
    /// The palette: what vertices follow. At most [`MAX_JOINTS`].
    pub joints: Vec<Joint>,
    /// One per vertex of the mesh, in its order.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub vertices: Vec<Bind>,
    /// Shapes to blend. Those of one name are one, whichever parts of the mesh they move.
    pub targets: Vec<Target>,
    /// Motions, in the file's order.
    pub animations: Vec<Animation>,
    /// From the file's space (glTF: Y up, metres) to the groom's: a similarity, and the identity until the
    /// mesh is oriented.
    pub to_groom: Mat4,
}

/// A coordinate system that moves with its parent's.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Node {
    /// Its name, empty if it has none. Names need not be unique.
    pub name: String,
    /// The node that it moves with.
    pub parent: Option<u32>,
    /// Where it is in its parent while nothing animates it.
    pub rest: Transform,
    /// The same as a matrix, where the file has one: a matrix may shear, which `rest` cannot. It holds
    /// while nothing animates the node.
    pub matrix: Option<Mat4>,
    /// Weights of its mesh's shapes while nothing animates them: target of the rig and weight. What is
    /// not listed has 0.
    pub weights: Vec<(u32, f32)>,
}

/// A move, a turn and a stretch: first the scale applies, then the rotation, then the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Transform {
    /// Units of the file.
    pub translation: Vec3,
    /// A unit quaternion.
    pub rotation: Quat,
    /// Factors along the three axes.
    pub scale: Vec3,
}

/// An entry of the palette. It brings a vertex to
/// `to_groom * global(node) * inverse_bind * position`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Joint {
    /// The node that it follows.
    pub node: u32,
    /// From the mesh's space to the node's as they were when the mesh was bound.
    pub inverse_bind: Mat4,
}

/// A vertex as the file has it, before any pose, and what it follows.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Bind {
    /// In the space of the file's mesh.
    pub position: Vec3,
    /// Unit, in the same space.
    pub normal: Vec3,
    /// Entries of the palette. Those with weight 0 mean nothing, but exist.
    pub joints: [u16; INFLUENCES],
    /// Their shares, none negative, the sum 1.
    pub weights: [f32; INFLUENCES],
}

/// A shape to blend, as what it adds to vertices at weight 1.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Target {
    /// Its name, unique in a rig.
    pub name: String,
    /// Only vertices that it moves, ascending.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub deltas: Vec<Delta>,
}

/// What a shape adds to a vertex, in the space of the file's mesh.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Delta {
    /// The vertex.
    pub vertex: u32,
    /// Added to its position.
    pub position: Vec3,
    /// Added to its normal.
    pub normal: Vec3,
}

impl Default for Transform {
    fn default() -> Self {
        Self { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE }
    }
}

impl Transform {
    /// The same as a matrix.
    pub fn matrix(&self) -> Mat4 {
        Mat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// What of a matrix is no shear. One that flattens has no rotation that could be known.
    pub fn from_matrix(matrix: Mat4) -> Self {
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        if rotation.is_finite() && rotation.length_squared() > 0.0 {
            return Self { translation, rotation: rotation.normalize(), scale };
        }
        Self { translation, rotation: Quat::IDENTITY, scale }
    }
}

impl Bind {
    /// A vertex that follows one entry of the palette and no other.
    pub fn rigid(position: Vec3, normal: Vec3, joint: u16) -> Self {
        let mut weights = [0.0; INFLUENCES];
        weights[0] = 1.0;
        Self { position, normal, joints: [joint; INFLUENCES], weights }
    }
}

impl Rig {
    /// The animation of this name, or else one whose name differs only in upper and lower case.
    pub fn animation(&self, name: &str) -> Option<&Animation> {
        let exact = self.animations.iter().find(|a| a.name == name);
        let lower = name.to_lowercase();
        exact.or_else(|| self.animations.iter().find(|a| a.name.to_lowercase() == lower))
    }

    /// The index of the shape of this name among [`Rig::targets`], or else of one whose name differs only
    /// in upper and lower case.
    pub fn target(&self, name: &str) -> Option<usize> {
        let exact = self.targets.iter().position(|t| t.name == name);
        let lower = name.to_lowercase();
        exact.or_else(|| self.targets.iter().position(|t| t.name.to_lowercase() == lower))
    }
}

#[cfg(all(test, feature = "gltf"))]
pub(crate) mod tests;
