//! The CPU side: what a groom is before the GPU sees it.

pub mod bind;
pub mod bound;
pub mod curve;
pub mod guides;
pub mod mesh;
pub mod sdf;
pub mod strands;

pub use bind::{BindOptions, GuideCount, bind};
pub use bound::{BoundStrands, Groom, Influence};
pub use guides::Guides;
pub use mesh::TriMesh;
pub use sdf::SdfGrid;
pub use strands::Strands;
