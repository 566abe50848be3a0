//! The file formats that are read and written, by extension: the only list of them.

use std::path::Path;

const ALEMBIC: &[&str] = when(cfg!(feature = "alembic"), &["abc"]);
const USD: &[&str] = when(cfg!(feature = "usd"), &["usd", "usda", "usdc", "usdz"]);
const USDC: &[&str] = when(cfg!(feature = "usd"), &["usdc"]);
const COOKED: &[&str] = when(cfg!(feature = "cooked"), &["tresses"]);

const READ: &[&[&str]] = &[&["tfx", "hair", "obj", "data", "ply", "glb", "gltf"], ALEMBIC, USD, COOKED];
const WRITES: &[&[&str]] = &[
    &["tfx", "hair", "obj", "data", "ply"],
    when(cfg!(feature = "gltf"), &["glb"]),
    ALEMBIC,
    &["usda"],
    USDC,
];
const FACES: &[&[&str]] = &[&["obj", "gltf", "glb", "tfxmesh"], ALEMBIC, USD];
const MOVES: &[&[&str]] = &[ALEMBIC, USD];

/// Grooms, read. An `.obj` is one when it has lines, a `.glb` or `.gltf` when it has `EXT_tresses_hair`.
pub const GROOMS: &[&str] = &joined::<{ count(READ) }>(READ);
/// Grooms, written.
pub const WRITTEN: &[&str] = &joined::<{ count(WRITES) }>(WRITES);
/// Heads and other meshes, read. An `.obj` is one when it has faces, an `.abc` or `.usd` when it has no curves.
pub const MESHES: &[&str] = &joined::<{ count(FACES) }>(FACES);
/// Grooms that may move.
pub const ANIMATED: &[&str] = &joined::<{ count(MOVES) }>(MOVES);
/// What meshes may need beside them.
pub const COMPANIONS: &[&str] = &["mtl", "bin", "png", "jpg", "jpeg"];

/// `list`, or nothing.
const fn when(there: bool, list: &'static [&'static str]) -> &'static [&'static str] {
    if there { list } else { &[] }
}

const fn count(lists: &[&[&str]]) -> usize {
    let (mut all, mut i) = (0, 0);
    while i < lists.len() {
        all += lists[i].len();
        i += 1;
    }
    all
}

/// `lists` as one of [`count`] entries.
const fn joined<const N: usize>(lists: &[&[&'static str]]) -> [&'static str; N] {
    let (mut all, mut n, mut i) = ([""; N], 0, 0);
    while i < lists.len() {
        let mut k = 0;
        while k < lists[i].len() {
            all[n] = lists[i][k];
            (n, k) = (n + 1, k + 1);
        }
        i += 1;
    }
    all
}

/// The extension of a file's name in lower case, or nothing.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Whether a file is called as a cooked groom is.
pub fn is_cooked(path: &Path) -> bool {
    extension(path) == "tresses"
}

/// Whether a file is called as glTF is, which may hold meshes, grooms or both.
pub fn is_gltf(path: &Path) -> bool {
    matches!(&*extension(path), "glb" | "gltf")
}

/// Whether a groom that is called so may hold its body.
pub fn may_hold_body(path: &Path) -> bool {
    is_gltf(path) || extension(path).starts_with("usd")
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
