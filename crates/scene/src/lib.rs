//! Shared by the command, the studio, the page and the Python package: a character from files or built in, its settings,
//! the motion of its head, its cameras, and all of it on the GPU. The library `tresses` does not depend on it.
//!
//! Each module depends only on modules above it in this list:
//!
//! - `words`: numbers as text.
//! - `picture`: images and animations as files.
//! - `shelf`: files by name, in memory or on the disk.
//! - `camera`: viewpoints and shots.
//! - `motion`: motions, built in or from keyframe files.
//! - `source`: the names of a character's files.
//! - `settings`: all parameters, as one value.
//! - `quality`: the size of images and how finely they are sampled.
//! - `knobs`: the table of all parameters, with units, ranges and hints.
//! - `colliders`: obstacles from a file.
//! - `companions`: readers of the files beside groom and head.
//! - `options`: the library's options that settings come to.
//! - `preset`: settings and the names of files as one text file.
//! - `open`: the character of a preset.
//! - `history`: undo and redo.
//! - `scene`: a character on the GPU, with its obstacles, lighting and view.
//! - `crowd`: many instances of a character.
//! - `measure`: the time that frames take.

pub mod camera;
pub mod colliders;
pub mod companions;
pub mod crowd;
#[cfg(test)]
mod damaged;
pub mod history;
pub mod knobs;
#[cfg(not(target_arch = "wasm32"))]
pub mod measure;
pub mod motion;
mod open;
pub mod options;
pub mod picture;
pub mod preset;
mod quality;
pub mod scene;
pub mod settings;
mod shelf;
pub mod source;
pub mod words;

pub use camera::{Shot, Viewpoint};
pub use colliders::Colliders;
pub use companions::{Companions, Surroundings};
pub use crowd::{Crowd, CrowdOptions};
pub use history::History;
pub use knobs::{Change, Changes, Knob, Value};
pub use motion::Motion;
pub use preset::Preset;
pub use quality::Quality;
pub use scene::{Facts, Scene};
pub use settings::Settings;
pub use shelf::Shelf;
pub use source::{Companion, Source};
pub use tresses::groom::rig::anatomy::{self, Anatomy};
