//! Code that the command line, the studio, the web page and the Python package share: characters from files or built
//! in, their settings, head motion, cameras, and the scene on the GPU. The library `tresses` does not depend on this
//! crate.
//!
//! Each module depends only on modules above it in this list:
//!
//! - `words`: number formatting.
//! - `picture`: images and animations as files.
//! - `shelf`: files by name, in memory or on disk.
//! - `camera`: viewpoints and shots.
//! - `motion`: motions, built in or from keyframe files.
//! - `source`: names of the files that a character is built from.
//! - `settings`: all parameters as one value.
//! - `quality`: image size and sampling.
//! - `knobs`: the table of all parameters, with units, ranges and hints.
//! - `colliders`: colliders from a file.
//! - `companion_files`: readers of the files that accompany a groom and its head.
//! - `options`: conversion of settings to the library's options.
//! - `preset`: settings and file names as one text file.
//! - `open`: loading a preset's character.
//! - `history`: undo and redo.
//! - `scene`: a character on the GPU with colliders, lighting and a view.
//! - `cards`: cards as files, and their simulated motion.
//! - `crowd`: many instances of a character.
//! - `measure`: frame timing.

pub mod camera;
pub mod cards;
pub mod colliders;
pub mod companion_files;
pub mod crowd;
#[cfg(test)]
mod damaged;
pub mod history;
pub mod knobs;
#[cfg(not(target_arch = "wasm32"))]
pub mod measure;
pub mod motion;
pub mod open;
pub mod options;
pub mod picture;
pub mod preset;
mod quality;
pub mod scene;
pub mod settings;
mod shelf;
pub mod source;
pub mod words;

pub use camera::{CaptureCamera, Shot, Viewpoint};
pub use colliders::Colliders;
pub use companion_files::{CompanionFiles, EnvironmentMap};
pub use crowd::{Crowd, CrowdOptions};
pub use history::History;
pub use knobs::{Change, Changes, Knob, Value};
pub use motion::Motion;
pub use preset::Preset;
pub use quality::Quality;
pub use scene::{Facts, Scene};
pub use settings::Settings;
pub use shelf::Shelf;
pub use source::{Companion, PresetSource};
pub use tresses::groom::rig::anatomy::{self, Anatomy};
