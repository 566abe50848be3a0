//! Heads of other meshes: their landmarks, and their size and place relative to the built-in head.

mod find;
mod fit;

pub use find::HeadShape;
pub use fit::HeadFit;
