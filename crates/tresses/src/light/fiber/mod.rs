//! placeholder
pub mod bsdf;
pub mod far;
pub mod mean;
pub mod tables;
pub use bsdf::FiberShape;
pub use far::FarField;
pub use tables::FiberTables;
