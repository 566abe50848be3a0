//! What files can hold.

/// Something that a file can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Strands: their vertices.
    Strands,
    /// Widths along strands.
    Widths,
    /// Colors along strands.
    Colors,
    /// Texture coordinates of roots on the scalp.
    RootUvs,
    /// Tips that are fixed to the head as roots are.
    PinnedTips,
    /// Marks of guides, numbers and groups of strands, and the guides that strands follow.
    Guides,
    /// The number of followers around each strand.
    Followers,
    /// The material of the hair.
    Look,
    /// Unit and axes.
    Units,
    /// Hair that moves, frame by frame.
    Frames,
    /// A triangle mesh.
    Mesh,
    /// Textures of the mesh.
    Textures,
    /// Joints and blend shapes of the mesh.
    Rig,
    /// Animations of the joints and blend shapes.
    Animations,
    /// The data that opening a groom computes.
    Computed,
}

impl Content {
    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Strands => "strands",
            Self::Widths => "widths",
            Self::Colors => "colors",
            Self::RootUvs => "scalp texture coordinates",
            Self::PinnedTips => "pinned tips",
            Self::Guides => "guides and groups",
            Self::Followers => "numbers of followers",
            Self::Look => "hair material",
            Self::Units => "unit and axes",
            Self::Frames => "frames of moving hair",
            Self::Mesh => "mesh",
            Self::Textures => "textures",
            Self::Rig => "joints and blend shapes",
            Self::Animations => "animations",
            Self::Computed => "what opening computes",
        }
    }
}
