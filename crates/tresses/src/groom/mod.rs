//! The CPU side: what a groom is before the GPU sees it.

pub mod grow;
pub mod mannequin;
pub mod mesh;
pub mod sdf;
pub mod strands;
pub mod styles;

pub use mesh::TriMesh;
pub use sdf::SdfGrid;
pub use strands::Strands;
