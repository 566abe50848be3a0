//! The stages of the frame, in order: the names of folders, timing rows and chapters.

/// A stage of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Bodies bend.
    Skinning,
    /// Roots go with skin that bends.
    Roots,
    /// Guides fill a grid of density and velocity.
    Volume,
    /// Air moves around the head and through the hair.
    Wind,
    /// Guides move.
    Simulate,
    /// Guides become smooth curves.
    Tessellate,
    /// Guides become drawn strands.
    Interpolate,
    /// Strands that entered an obstacle leave it.
    Avoid,
    /// Shadow maps, and shading per strand vertex.
    Light,
    /// Background, body and hair into the HDR target.
    Draw,
    /// Resolve and tone mapping.
    Present,
}

impl Stage {
    /// All stages in the order of the frame.
    pub const ALL: [Self; 11] = [
        Self::Skinning,
        Self::Roots,
        Self::Volume,
        Self::Wind,
        Self::Simulate,
        Self::Tessellate,
        Self::Interpolate,
        Self::Avoid,
        Self::Light,
        Self::Draw,
        Self::Present,
    ];

    /// The folder below `src`, the timing row, the heading in ARCHITECTURE.md.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Skinning => "skinning",
            Self::Roots => "roots",
            Self::Volume => "volume",
            Self::Wind => "wind",
            Self::Simulate => "simulate",
            Self::Tessellate => "tessellate",
            Self::Interpolate => "interpolate",
            Self::Avoid => "avoid",
            Self::Light => "light",
            Self::Draw => "draw",
            Self::Present => "present",
        }
    }

    /// What one thread or vertex of the stage works on.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Skinning => "body vertex",
            Self::Roots => "guide, strand",
            Self::Volume => "guide vertex and cell",
            Self::Wind => "cell",
            Self::Simulate | Self::Tessellate => "guide",
            Self::Interpolate => "strand",
            Self::Avoid => "eight strand vertices, strand",
            Self::Light => "strand vertex",
            Self::Draw => "strip vertex and pixel",
            Self::Present => "pixel",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_stage_has_its_folder_and_its_chapter() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let chapters = std::fs::read_to_string(root.join("../../ARCHITECTURE.md")).unwrap();
        let mut place = 0;
        for stage in Stage::ALL {
            let module = std::fs::read_to_string(root.join("src").join(stage.name()).join("mod.rs")).unwrap();
            assert!(module.starts_with("//!"), "{stage:?} opens with its chapter");
            let row = format!("| `{}` | per {}", stage.name(), stage.unit());
            let found = chapters[place..].find(&row);
            place += found.unwrap_or_else(|| panic!("ARCHITECTURE.md lists {row:?} in its place"));
        }
    }
}
