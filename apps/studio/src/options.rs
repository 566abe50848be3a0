//! What the studio is started with.

use std::path::PathBuf;
use tresses::groom::import::ImportOptions;

/// What the studio shows first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The files of one groom; none for a built-in style.
    pub grooms: Vec<PathBuf>,
    /// The meshes of the head it grows on.
    pub heads: Vec<PathBuf>,
    /// The built-in style, when there is no groom: one of [`tresses::groom::styles::Style::NAMES`].
    pub style: Option<String>,
    /// What is known of the files' units and axes.
    pub import: ImportOptions,
}
