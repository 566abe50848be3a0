//! Shared by the command and the studio: a character from files or built in, its settings, the motion of its
//! head, its cameras, and all of it on the GPU. The library `tresses` does not depend on it.

mod aside;
pub mod camera;
pub mod character;
pub mod colliders;
pub mod companions;
pub mod crowd;
#[cfg(test)]
mod damaged;
pub mod face;
pub mod history;
pub mod knobs;
pub mod living;
#[cfg(not(target_arch = "wasm32"))]
pub mod measure;
pub mod motion;
pub mod picture;
pub mod preset;
pub mod scene;
pub mod settings;
pub mod words;

pub use camera::{Bounds, Shot, Viewpoint};
pub use character::{Base, Character, Files, Growing, Styling};
pub use colliders::Colliders;
pub use companions::{Companion, Companions, Shelf, Surroundings};
pub use crowd::{Crowd, CrowdOptions};
pub use history::History;
pub use knobs::{Knob, Value};
pub use living::Living;
pub use motion::{Gesture, Motion};
pub use preset::Preset;
pub use scene::{Facts, Quality, Scene};
pub use settings::{Change, Changes, Settings};
pub use tresses::groom::rig::anatomy::{self, Anatomy};
