//! Report of a groom import.

use crate::{Followers, Look, Rig, Strands, light::PunctualLight, lint, orient};
use std::path::PathBuf;

/// Contents of one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileReport {
    /// Path of the file.
    pub path: PathBuf,
    /// Format and version.
    pub format: &'static str,
    /// Number of strands.
    pub strands: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Changes and omissions while reading.
    pub notes: Vec<String>,
}

/// Contents of the imported files and the changes made to them.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportReport {
    /// One report per groom file, in the order given.
    pub files: Vec<FileReport>,
    /// Conversion of the groom to meters, Y up, face toward +Z.
    pub placement: orient::Placement,
    /// Conversion of the head.
    pub head_placement: Option<orient::Placement>,
    /// Rig of the head, if its files have one.
    pub rig: Option<Rig>,
    /// Lights in the files of groom and head.
    pub lights: Vec<PunctualLight>,
    /// Lint findings before the repair.
    pub lint: lint::LintReport,
    /// Changes made by the repair.
    pub repaired: lint::RepairReport,
    /// Child strands that the files request, one entry per strand, radii in meters; empty if they request none.
    pub followers: Vec<Followers>,
    /// Groups of strands in the files, by number; empty without groups.
    pub groups: Vec<StrandGroup>,
    /// Attributes of strands and vertices in the files.
    pub attributes: Attributes,
    /// Appearance of the hair, from the first file that describes it.
    pub look: Option<Look>,
}

/// A group of strands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct StrandGroup {
    /// Number of the group.
    pub id: i32,
    /// Name of the group, if the file has one.
    pub name: String,
    /// Number of strands, guides included.
    pub strands: usize,
    /// Number of guides.
    pub guides: usize,
}

/// Attributes that the files contain.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Attributes {
    /// Whether there is a width at each vertex.
    pub widths: bool,
    /// Whether there is a color at each vertex.
    pub colors: bool,
    /// Whether there are scalp texture coordinates.
    pub root_uvs: bool,
    /// Whether strands have numbers.
    pub ids: bool,
    /// Number of strands that are guides.
    pub guides: usize,
    /// Number of strands that name the guides they follow.
    pub bound: usize,
    /// Names of the custom attributes.
    pub custom: Vec<String>,
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
            custom: strands.attributes.iter().map(|attribute| attribute.name.clone()).collect(),
        }
    }
}

impl ImportReport {
    /// Returns the number of strands, including all child strands that the files request.
    pub fn with_followers(&self) -> u64 {
        self.followers.iter().map(|followers| 1 + u64::from(followers.count)).sum()
    }
}
