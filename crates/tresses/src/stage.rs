//! The stages of the frame, in order: one row each, for the rows of times and the chapters.

/// Declares the stages: variant, name, folder below `src`, the work of one thread or vertex.
macro_rules! stages {
    ($($(#[$doc:meta])+ $stage:ident $name:literal $folder:literal $unit:literal,)+) => {
        /// A part of the frame that is timed.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Stage {
            $($(#[$doc])+ $stage,)+
        }

        impl Stage {
            /// All stages in the order of the frame.
            pub const ALL: &[Self] = &[$(Self::$stage),+];

            /// The name of its row of times.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$stage => $name),+ }
            }

            /// The folder below `src` and the heading in ARCHITECTURE.md.
            pub const fn folder(self) -> &'static str {
                match self { $(Self::$stage => $folder),+ }
            }

            /// The work of one thread or vertex.
            pub const fn unit(self) -> &'static str {
                match self { $(Self::$stage => $unit),+ }
            }
        }
    };
}

stages! {
    /// Skinned meshes are posed.
    Skinning "skinning" "skinning" "body vertex",
    /// Roots and fields follow skinned meshes.
    Roots "roots" "roots" "guide, strand",
    /// Guides fill a grid of density and velocity.
    Volume "volume" "volume" "guide vertex and cell",
    /// Air moves around the head and through the hair.
    Wind "wind" "wind" "cell",
    /// Guides move.
    Simulate "simulate" "simulate" "guide",
    /// Guides become smooth curves.
    Tessellate "tessellate" "tessellate" "guide",
    /// Guides become drawn strands.
    Interpolate "interpolate" "interpolate" "strand",
    /// Strands that entered an obstacle leave it.
    Avoid "avoid" "avoid" "eight strand vertices, strand",
    /// Shadow maps.
    Shadow "shadow" "light" "strand vertex",
    /// Ambient light in a grid of cells.
    Ambient "ambient" "light" "cell",
    /// Shading of strands.
    Shade "shade" "light" "strand vertex",
    /// Bodies.
    Body "body" "draw" "strip vertex and pixel",
    /// Tiles: segments are sorted into lists.
    Bins "bins" "draw" "segment and tile",
    /// Tiles: the visible segments are found.
    See "see" "draw" "row of a tile",
    /// Depth peeling: the optical thickness behind the layers.
    Thickness "thickness" "draw" "strip vertex and pixel",
    /// Hair into the HDR target.
    Hair "hair" "draw" "strip vertex and pixel, or row of a tile",
    /// Hair over a scene of the host.
    Embed "embed" "draw" "pixel",
    /// Resolve and tone mapping.
    Present "present" "present" "pixel",
    /// Debug views.
    Debug "debug" "views" "pixel",
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_stage_has_its_folder_and_its_chapter() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let chapters = std::fs::read_to_string(root.join("../../ARCHITECTURE.md")).unwrap();
        let (mut place, mut before) = (0, "");
        for stage in Stage::ALL.iter().filter(|stage| **stage != Stage::Debug) {
            let folder = stage.folder();
            if folder == before {
                continue;
            }
            before = folder;
            let module = std::fs::read_to_string(root.join("src").join(folder).join("mod.rs")).unwrap();
            assert!(module.starts_with("//!"), "{stage:?} opens with its chapter");
            let row = format!("| `{folder}` | per {}", stage.unit());
            let found = chapters[place..].find(&row);
            place += found.unwrap_or_else(|| panic!("ARCHITECTURE.md lists {row:?} in its place"));
        }
    }
}
