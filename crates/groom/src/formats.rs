//! The file formats that are read and written, by extension: the only list of them.

use std::path::Path;

/// Grooms, read. An `.obj` is one when it has lines, a `.glb` or `.gltf` when it has `EXT_tresses_hair`.
pub const GROOMS: &[&str] = match (cfg!(feature = "alembic"), cfg!(feature = "usd")) {
    (true, true) => {
        &["tfx", "hair", "obj", "data", "ply", "glb", "gltf", "abc", "usd", "usda", "usdc", "usdz"]
    }
    (true, false) => &["tfx", "hair", "obj", "data", "ply", "glb", "gltf", "abc"],
    (false, true) => &["tfx", "hair", "obj", "data", "ply", "glb", "gltf", "usd", "usda", "usdc", "usdz"],
    (false, false) => &["tfx", "hair", "obj", "data", "ply", "glb", "gltf"],
};
/// Grooms, written.
pub const WRITTEN: &[&str] = match (cfg!(feature = "alembic"), cfg!(feature = "gltf")) {
    (true, true) => &["tfx", "hair", "obj", "data", "ply", "glb", "abc", "usda"],
    (true, false) => &["tfx", "hair", "obj", "data", "ply", "abc", "usda"],
    (false, true) => &["tfx", "hair", "obj", "data", "ply", "glb", "usda"],
    (false, false) => &["tfx", "hair", "obj", "data", "ply", "usda"],
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

/// Whether a file is called as glTF is, which may hold meshes, grooms or both.
pub fn is_gltf(path: &Path) -> bool {
    matches!(&*extension(path), "glb" | "gltf")
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
