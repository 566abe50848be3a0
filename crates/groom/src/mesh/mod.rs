//! Triangle meshes: heads and bodies that hair grows on and collides with.

pub mod bvh;
mod edit;
pub mod paint;
mod parts;
pub mod sdf;
pub mod shapes;
mod simplify;
pub(crate) mod triangle;

use glam::Vec3;
use std::sync::Arc;

pub use bvh::{Bvh, Closest, TreeNode};
pub use paint::Paint;
pub use parts::{MeshPart, weld_map};
pub use sdf::SdfOptions;
pub use simplify::MeshLevel;

/// A triangle mesh, meters, in the same space as the groom.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct TriMesh {
    /// Vertex positions.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub positions: Vec<Vec3>,
    /// Unit normals, one per vertex.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub normals: Vec<Vec3>,
    /// Linear colors, one per vertex, or empty for the default color of the body.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub colors: Vec<Vec3>,
    /// Vertex indices, counterclockwise seen from outside.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub triangles: Vec<[u32; 3]>,
    /// Textures of the surface, if its materials have images.
    #[cfg_attr(feature = "cooked", serde(with = "paint::shared"))]
    pub paint: Option<Arc<Paint>>,
}

impl TriMesh {
    /// Returns the minimum and maximum corner, or `None` without vertices.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p))))
    }
}
