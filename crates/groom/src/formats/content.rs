//! Kinds of data that a file can hold.

/// A kind of data that a file can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContentKind {
    /// Vertices of strands.
    Strands,
    /// Widths along strands.
    Widths,
    /// Colors along strands.
    Colors,
    /// Texture coordinates of roots on the scalp.
    RootUvs,
    /// Tips pinned to the head, as roots are.
    PinnedTips,
    /// Guide marks, ids and groups of strands, and the guides that each strand follows.
    Guides,
    /// Custom attributes of strands and vertices, by name.
    Attributes,
    /// Number of child strands around each strand.
    Followers,
    /// Hair material.
    Look,
    /// Unit and axes.
    Units,
    /// Positions of moving hair, frame by frame.
    Frames,
    /// A triangle mesh.
    Mesh,
    /// Textures of the mesh.
    Textures,
    /// Joints and blend shapes of the mesh.
    Rig,
    /// Animations of the joints and blend shapes.
    Animations,
    /// Lights of the scene.
    Lights,
    /// Data that opening a groom computes.
    Computed,
}

impl ContentKind {
    /// Returns the name for use in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Strands => "strands",
            Self::Widths => "widths",
            Self::Colors => "colors",
            Self::RootUvs => "scalp texture coordinates",
            Self::PinnedTips => "pinned tips",
            Self::Guides => "guides and groups",
            Self::Attributes => "custom attributes",
            Self::Followers => "child strand counts",
            Self::Look => "hair material",
            Self::Units => "unit and axes",
            Self::Frames => "frames of moving hair",
            Self::Mesh => "mesh",
            Self::Textures => "textures",
            Self::Rig => "joints and blend shapes",
            Self::Animations => "animations",
            Self::Lights => "lights",
            Self::Computed => "precomputed data",
        }
    }
}
