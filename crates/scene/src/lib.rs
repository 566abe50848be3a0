//! What the command and the studio share: a character from files or built in, how its head moves and
//! who looks at it, and all of it on the GPU. The library `tresses` knows nothing of it.

pub mod camera;
pub mod character;
pub mod colliders;
#[cfg(not(target_arch = "wasm32"))]
mod measure;
pub mod motion;
pub mod stage;

pub use camera::{Bounds, Camera, Shot};
pub use character::{Base, Character, Files, Styling};
pub use colliders::Colliders;
pub use motion::Motion;
pub use stage::{Facts, Quality, Stage};
