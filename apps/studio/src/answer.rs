//! Events from dialogs and the host page. The window handles them in its next frame.

use crate::{files::Files, hosted::Command, journal::LeftGroom};
use std::path::PathBuf;
use tresses::glam::Vec3;
use tresses_scene::{Companion, Shelf};

/// A file's path and content.
pub type Read = (PathBuf, Vec<u8>);

/// A user's choice in a dialog, a command of the host, or the result of background work.
#[derive(Clone, Debug)]
pub enum Answer {
    /// Opens groom and head files.
    Open(Files),
    /// Path and text of a preset, and the files dropped with it.
    Preset(PathBuf, String, Shelf),
    /// A companion file of the hair, its name, and the files dropped with it.
    Companion(&'static Companion, String, Shelf),
    /// Name of an image that may be any scalp map, and its bytes.
    Picture(String, Shelf),
    /// A command of the host.
    Do(Command),
    /// Shapes of the simulated guides to keep: groom space, meters.
    Kept(Vec<Vec3>),
    /// Groomed hair that an earlier studio has left.
    Left(LeftGroom),
    /// A success message.
    Wrote(String),
    /// An error message.
    Failed(String),
}
