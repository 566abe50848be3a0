//! The CPU side: what a groom is before the GPU sees it.

pub mod bind;
pub mod bound;
pub mod curve;
pub mod export;
pub mod grow;
pub mod guides;
pub mod import;
pub mod lint;
pub mod mannequin;
pub mod mesh;
pub mod orient;
pub mod restyle;
pub mod sdf;
pub mod strands;
pub mod styles;

pub use bind::{BindOptions, GuideCount, bind};
pub use bound::{BoundStrands, Groom, Influence};
pub use guides::Guides;
pub use mesh::TriMesh;
pub use restyle::Restyle;
pub use sdf::SdfGrid;
pub use strands::Strands;
