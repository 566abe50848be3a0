//! The file formats that are read and written, by extension: the only list of them.

use std::path::Path;

/// Grooms, read. An `.obj` is one when it has lines.
pub const GROOMS: &[&str] = match (cfg!(feature = "alembic"), cfg!(feature = "usd")) {
    (true, true) => &["tfx", "hair", "obj", "data", "ply", "abc", "usd", "usda", "usdc", "usdz"],
    (true, false) => &["tfx", "hair", "obj", "data", "ply", "abc"],
    (false, true) => &["tfx", "hair", "obj", "data", "ply", "usd", "usda", "usdc", "usdz"],
    (false, false) => &["tfx", "hair", "obj", "data", "ply"],
};
/// Grooms, written.
pub const WRITTEN: &[&str] = if cfg!(feature = "alembic") {
    &["tfx", "hair", "obj", "data", "ply", "abc", "usda"]
} else {
    &["tfx", "hair", "obj", "data", "ply", "usda"]
};
/// Heads and other meshes, read. An `.obj` is one when it has faces, an `.abc` or `.usd` when it has no curves.
pub const MESHES: &[&str] = match (cfg!(feature = "alembic"), cfg!(feature = "usd")) {
    (true, true) => &["obj", "gltf", "glb", "tfxmesh", "abc", "usd", "usda", "usdc", "usdz"],
    (true, false) => &["obj", "gltf", "glb", "tfxmesh", "abc"],
    (false, true) => &["obj", "gltf", "glb", "tfxmesh", "usd", "usda", "usdc", "usdz"],
    (false, false) => &["obj", "gltf", "glb", "tfxmesh"],
};
/// Grooms that may move.
pub const ANIMATED: &[&str] = match (cfg!(feature = "alembic"), cfg!(feature = "usd")) {
    (true, true) => &["abc", "usd", "usda", "usdc", "usdz"],
    (true, false) => &["abc"],
    (false, true) => &["usd", "usda", "usdc", "usdz"],
    (false, false) => &[],
};
/// What meshes may need beside them.
pub const COMPANIONS: &[&str] = &["mtl", "bin"];

/// The extension of a file's name in lower case, or nothing.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Extensions for a sentence, `joint` before the last: ".tfx, .hair or .obj".
pub fn listed(extensions: &[&str], joint: &str) -> String {
    let dotted: Vec<_> = extensions.iter().map(|extension| format!(".{extension}")).collect();
    match dotted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} {joint} {last}", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_make_a_sentence() {
        assert_eq!(listed(&["tfx", "hair", "obj"], "or"), ".tfx, .hair or .obj");
        assert_eq!(listed(&["png"], "or"), ".png");
        assert_eq!(extension(Path::new("a/B.GLTF")), "gltf");
    }
}
