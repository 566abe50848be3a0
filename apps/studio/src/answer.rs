//! Answers of dialogs and hosts, which the window receives with its next frame.

use crate::{files::Files, hosted::Command};
use std::path::PathBuf;
use tresses_scene::{Companion, Shelf};

/// A file that was read.
pub type Read = (PathBuf, Vec<u8>);

/// A choice of the user or a command of the host.
#[derive(Clone, Debug)]
pub enum Answer {
    /// Groom and head files to open.
    Open(Files),
    /// The text of a preset, where it is from, and the files that came with it.
    Preset(PathBuf, String, Shelf),
    /// A companion of the hair, its file name, and the files that came with it.
    Companion(&'static Companion, String, Shelf),
    /// A picture that may be any map.
    Picture(String, Shelf),
    /// A command of the host.
    Do(Command),
    /// Something was written.
    Wrote(String),
    /// Something went wrong.
    Failed(String),
}
