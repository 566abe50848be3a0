//! The stages of a frame in order. Timings and the table in ARCHITECTURE.md have one row per stage.

/// Declares the stages: variant, name, folder below `src`, unit of work per thread or vertex.
macro_rules! stages {
    ($($(#[$doc:meta])+ $stage:ident $name:literal $folder:literal $unit:literal,)+) => {
        /// A part of the frame that is timed.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Stage {
            $($(#[$doc])+ $stage,)+
        }

        impl Stage {
            /// All stages in the order of a frame.
            #[cfg(test)]
            pub const ALL: &[Self] = &[$(Self::$stage),+];

            /// Returns the name of the stage in timings.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$stage => $name),+ }
            }

            /// Returns the folder below `src`, which is also the stage's name in ARCHITECTURE.md.
            #[cfg(test)]
            pub const fn folder(self) -> &'static str {
                match self { $(Self::$stage => $folder),+ }
            }

            /// Returns the unit of work of one thread or vertex.
            #[cfg(test)]
            pub const fn unit(self) -> &'static str {
                match self { $(Self::$stage => $unit),+ }
            }
        }
    };
}

stages! {
    /// Poses skinned meshes.
    Skinning "skinning" "skinning" "body vertex",
    /// Moves roots and deforms fields with skinned meshes.
    Roots "roots" "roots" "guide, strand",
    /// Splats guides into a grid of density and velocity.
    Volume "volume" "volume" "guide vertex and cell",
    /// Simulates the air around the head and through the hair.
    Wind "wind" "wind" "cell",
    /// Simulates the guides.
    Simulate "simulate" "simulate" "guide",
    /// Turns guides into smooth curves.
    Tessellate "tessellate" "tessellate" "guide",
    /// Interpolates drawn strands between guides.
    Interpolate "interpolate" "interpolate" "strand",
    /// Pushes strands out of obstacles.
    Avoid "avoid" "avoid" "eight strand vertices, strand",
    /// Shadow maps.
    Shadow "shadow" "light" "strand vertex",
    /// Ambient light in a grid of cells.
    Ambient "ambient" "light" "cell",
    /// Shading of strands.
    Shade "shade" "light" "strand vertex",
    /// Draws bodies.
    Body "body" "draw" "strip vertex and pixel",
    /// Tiles: sorts segments into lists.
    Bins "bins" "draw" "segment and tile",
    /// Tiles: finds the visible segments.
    Visibility "see" "draw" "row of a tile",
    /// Depth peeling: accumulates the optical thickness behind the layers.
    Thickness "thickness" "draw" "strip vertex and pixel",
    /// Draws hair into the HDR target.
    Hair "hair" "draw" "strip vertex and pixel, or row of a tile",
    /// Composites hair into a scene of the host.
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
    fn every_stage_has_folder_and_architecture_row() {
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
