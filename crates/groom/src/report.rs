//! What importing a groom found and did.

use crate::{Followers, Look, Rig, Strands, lint, orient};
use std::path::PathBuf;

/// What one file held.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileReport {
    /// The file.
    pub path: PathBuf,
    /// Format and version.
    pub format: &'static str,
    /// Strands in it.
    pub strands: usize,
    /// Vertices in it.
    pub vertices: usize,
    /// What was done on the way, or left out.
    pub notes: Vec<String>,
}

/// What was read and what was done with it.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportReport {
    /// One per groom file, in the order given.
    pub files: Vec<FileReport>,
    /// How the groom came into metres, Y up, face +Z.
    pub placement: orient::Placement,
    /// How the head did.
    pub head_placement: Option<orient::Placement>,
    /// What bends the head, if its files have that.
    pub rig: Option<Rig>,
    /// What the groom was like before the repair.
    pub lint: lint::Report,
    /// What the repair did.
    pub repaired: lint::Repaired,
    /// The followers that the files ask for, one entry per strand, radii in metres; empty where none do.
    pub followers: Vec<Followers>,
    /// The groups that the files sort their strands into, by number; empty where they do not.
    pub groups: Vec<Group>,
    /// What attributes the files have of each strand or vertex.
    pub attributes: Attributes,
    /// What the first file that says so has its hair look like.
    pub look: Option<Look>,
}

/// Strands that belong together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Group {
    /// Its number.
    pub id: i32,
    /// Its name, where the file has one.
    pub name: String,
    /// Strands in it, guides among them.
    pub strands: usize,
    /// Guides in it.
    pub guides: usize,
}

/// Which attributes there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Attributes {
    /// A width at each vertex.
    pub widths: bool,
    /// A colour at each vertex.
    pub colors: bool,
    /// Scalp texture coordinates.
    pub root_uvs: bool,
    /// Strands have numbers.
    pub ids: bool,
    /// Strands that are guides.
    pub guides: usize,
    /// Strands that say which guides they follow.
    pub bound: usize,
}

impl Attributes {
    pub(crate) fn of(strands: &Strands) -> Self {
        Self {
            widths: !strands.radii.is_empty(),
            colors: !strands.colors.is_empty(),
            root_uvs: !strands.root_uvs.is_empty(),
            ids: !strands.marks.is_empty(),
            guides: strands.marks.iter().filter(|mark| mark.guide).count(),
            bound: strands.marks.iter().filter(|mark| mark.weights != [0.0; 3]).count(),
        }
    }
}

impl ImportReport {
    /// How many strands there are with all followers that the files ask for.
    pub fn with_followers(&self) -> u64 {
        self.followers.iter().map(|followers| 1 + u64::from(followers.count)).sum()
    }
}
