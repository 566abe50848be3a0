//! Scenes with stored images of the software driver. `tools/evidence/same-images` reads the list, too.

/// Options of all scenes.
pub const COMMON: &str = "--size 200x150 --frames 2";

/// A scene and its stored image.
#[derive(Clone, Copy, Debug)]
pub struct SceneCase {
    /// Name, and the name of the stored file without `.png`.
    pub name: &'static str,
    /// Options of `tresses render` besides [`COMMON`].
    pub options: &'static str,
    /// The stored PNG file; empty if no image is stored.
    pub stored: &'static [u8],
}

/// Lists scenes by name and options. `tresses gpu --store FOLDER` draws the images.
macro_rules! scenes {
    ($($name:literal: $options:literal,)*) => {
        &[$(SceneCase {
            name: $name,
            options: $options,
            stored: include_bytes!(concat!("../../assets/gpu-report/", $name, ".png")),
        }),*]
    };
}

/// All scenes.
pub const SCENES: &[SceneCase] = scenes! {
    "long": "--strands 2000",
    "bob": "--style bob --strands 2000 --camera side",
    "curls": "--strands 1500 --curl waves --set style.curl_radius=8mm",
    "masks": "--strands 1500 --renderer masks --camera front",
    "masks-kajiya-kay": "--strands 1500 --renderer masks --shading kajiya-kay",
    "peel-deep": "--strands 1500 --coverage peel --classic-shadows deep",
    "alpha-deep": "--strands 1500 --coverage alpha --classic-shadows deep",
    "peel-deep-pixel": "--strands 1500 --coverage peel --classic-shadows deep --shade-per pixel",
    "alpha-deep-pixel": "--strands 1500 --coverage alpha --classic-shadows deep --shade-per pixel",
    "peel-absorption": "--strands 1500 --coverage peel --classic-shadows absorption",
    "alpha-absorption": "--strands 1500 --coverage alpha --classic-shadows absorption",
    "peel-absorption-pixel": "--strands 1500 --coverage peel --classic-shadows absorption --shade-per pixel",
    "alpha-absorption-pixel": "--strands 1500 --coverage alpha --classic-shadows absorption --shade-per pixel",
    "peel-opaque": "--strands 1500 --coverage peel --classic-shadows opaque",
    "alpha-opaque": "--strands 1500 --coverage alpha --classic-shadows opaque",
    "peel-opaque-pixel": "--strands 1500 --coverage peel --classic-shadows opaque --shade-per pixel",
    "alpha-opaque-pixel": "--strands 1500 --coverage alpha --classic-shadows opaque --shade-per pixel",
    "no-shadows": "--strands 1500 --shadows off",
    "kajiya-kay": "--strands 1500 --shading kajiya-kay --beard full",
    "wind": "--strands 1000 --wind 8,45 --motion turn",
    "turn": "--strands 1000 --motion turn --beard stubble",
    "supersampled": "--strands 1500 --camera back --ssaa 2",
    "far": "--strands 1500 --lod auto --zoom 0.1",
    "density": "--strands 1000 --debug density",
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_images_are_small() {
        let bytes: usize = SCENES.iter().map(|scene| scene.stored.len()).sum();
        assert!(bytes < 3_000_000, "{bytes} bytes");
    }
}
