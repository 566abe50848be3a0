//! The CPU side: what a groom is before the GPU sees it.

pub mod mesh;
pub mod resample;
pub mod sdf;
pub mod strands;

pub use mesh::TriMesh;
pub use sdf::SdfGrid;
pub use strands::Strands;
