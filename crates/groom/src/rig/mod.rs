//! Rigs of skinned meshes: joints, blend shapes and animations.
//!
//! ```text
//! Rig ── pose(animation, time) ─► RigPose ── deform ─► TriMesh
//!  nodes, joints,                  globals, palette,    positions,
//!  targets, animations             weights              normals
//! ```
//!
//! A pose is small: one matrix per joint and one weight per blend shape. Deforming the vertices ([`Rig::deform`]) needs
//! nothing else, so a GPU can do it as well.

pub mod anatomy;
mod animation;
mod deform;
mod join;
mod pose;

pub use animation::{Animation, Channel, Curve, Interpolation, Property};
pub use pose::RigPose;

use glam::{Mat4, Quat, Vec3};

/// Maximum number of palette entries of a rig, limited by 16-bit indices.
pub const MAX_JOINTS: usize = 1 << 16;
/// Maximum number of joints per vertex.
pub const INFLUENCES: usize = 8;

/// Rig of a skinned mesh: vertices that follow joints, blend shapes, and animations.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Rig {
    /// Nodes, a parent before its children.
    pub nodes: Vec<Node>,
    /// Palette of joints that vertices follow; at most [`MAX_JOINTS`].
    pub joints: Vec<Joint>,
    /// Skinning of each vertex of the mesh, in its order.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub vertices: Vec<Bind>,
    /// Blend shapes. Shapes with the same name are one, whichever parts of the mesh they move.
    pub targets: Vec<MorphTarget>,
    /// Animations, in the file's order.
    pub animations: Vec<Animation>,
    /// Transform from the file's space (glTF: Y up, meters) to groom space: a similarity, and the identity until the
    /// mesh is oriented.
    pub to_groom: Mat4,
}

/// A coordinate system relative to its parent.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Node {
    /// Name, empty if it has none. Names need not be unique.
    pub name: String,
    /// Parent node.
    pub parent: Option<u32>,
    /// Transform relative to the parent while nothing animates the node.
    pub rest: Transform,
    /// The same transform as a matrix, if the file has one: a matrix may shear, which `rest` cannot. It applies while
    /// nothing animates the node.
    pub matrix: Option<Mat4>,
    /// Weights of its mesh's blend shapes while nothing animates them: target of the rig and weight. Targets that are
    /// not listed have 0.
    pub weights: Vec<(u32, f32)>,
}

/// Translation, rotation and scale. The scale applies first, then the rotation, then the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Transform {
    /// Translation, in units of the file.
    pub translation: Vec3,
    /// Rotation, a unit quaternion.
    pub rotation: Quat,
    /// Scale factors along the three axes.
    pub scale: Vec3,
}

/// An entry of the palette. It maps a vertex to `to_groom * global(node) * inverse_bind * position`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Joint {
    /// Node that the joint follows.
    pub node: u32,
    /// Transform from the mesh's space to the node's space when the mesh was bound.
    pub inverse_bind: Mat4,
}

/// A vertex of the file before any pose, with its skin weights.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Bind {
    /// Position in the space of the file's mesh.
    pub position: Vec3,
    /// Unit normal in the same space.
    pub normal: Vec3,
    /// Palette indices. Those with weight 0 are unused, but valid.
    pub joints: [u16; INFLUENCES],
    /// Weights of the joints, none negative, the sum 1.
    pub weights: [f32; INFLUENCES],
}

/// A blend shape: the offsets that it adds to vertices at weight 1.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct MorphTarget {
    /// Name, unique in a rig.
    pub name: String,
    /// Offsets of the moved vertices, ascending by vertex.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub deltas: Vec<Delta>,
}

/// Offset of a vertex by a blend shape, in the space of the file's mesh.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Delta {
    /// Index of the vertex.
    pub vertex: u32,
    /// Offset of the position.
    pub position: Vec3,
    /// Offset of the normal.
    pub normal: Vec3,
}

impl Default for Transform {
    fn default() -> Self {
        Self { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE }
    }
}

impl Transform {
    /// Returns the transform as a matrix.
    pub fn matrix(&self) -> Mat4 {
        Mat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// Returns the transform of a matrix without its shear. If a singular matrix has no defined rotation, the rotation
    /// is the identity.
    pub fn from_matrix(matrix: Mat4) -> Self {
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        if rotation.is_finite() && rotation.length_squared() > 0.0 {
            return Self { translation, rotation: rotation.normalize(), scale };
        }
        Self { translation, rotation: Quat::IDENTITY, scale }
    }
}

impl Bind {
    /// Returns a vertex that follows a single entry of the palette.
    pub fn rigid(position: Vec3, normal: Vec3, joint: u16) -> Self {
        let mut weights = [0.0; INFLUENCES];
        weights[0] = 1.0;
        Self { position, normal, joints: [joint; INFLUENCES], weights }
    }
}

impl Rig {
    /// Returns the animation of this name, or else one whose name differs only in case.
    pub fn animation(&self, name: &str) -> Option<&Animation> {
        let exact = self.animations.iter().find(|a| a.name == name);
        let lower = name.to_lowercase();
        exact.or_else(|| self.animations.iter().find(|a| a.name.to_lowercase() == lower))
    }

    /// Returns the index among [`Rig::targets`] of the blend shape of this name, or else of one whose name differs only
    /// in case.
    pub fn target(&self, name: &str) -> Option<usize> {
        let exact = self.targets.iter().position(|t| t.name == name);
        let lower = name.to_lowercase();
        exact.or_else(|| self.targets.iter().position(|t| t.name.to_lowercase() == lower))
    }
}

#[cfg(all(test, feature = "gltf"))]
pub(crate) mod tests;
