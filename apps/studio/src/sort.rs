//! Sorts chosen or dropped files by name and content.

use crate::{
    answer::{Answer, Read},
    files::Files,
};
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::Arc,
};
use tresses::groom::import::{self, FileKind};
use tresses_scene::{
    Companion, Shelf,
    source::{COMPANION_FILES, companion},
};

/// Whether only the bytes of files are available, as in a browser. On a desktop, readers open the path again and find
/// companion files next to it.
pub const IN_MEMORY: bool = cfg!(target_arch = "wasm32");

/// Returns the action for each file. `in_memory`: only the bytes are available.
pub fn files(mut files: Vec<Read>, in_memory: bool) -> Vec<Answer> {
    if let Some(at) = files.iter().position(|(path, _)| has_ending(path, &["toml"])) {
        let (path, bytes) = files.swap_remove(at);
        return match String::from_utf8(bytes) {
            Ok(text) => vec![Answer::Preset(path, text, shelf(files, in_memory))],
            Err(_) => vec![Answer::Failed(format!("{} is not UTF-8 text", path.display()))],
        };
    }
    let mut actions = Vec::new();
    while let Some(at) = files.iter().position(|(path, _)| has_ending(path, &["json"])) {
        let list = files.swap_remove(at);
        let text = String::from_utf8_lossy(&list.1).into_owned();
        let named: Vec<Read> = files.extract_if(.., |(path, _)| is_named(path, &text)).collect();
        actions.push(match what(&list.1) {
            Some(companion) => put(companion, list, named, in_memory),
            None => {
                let name = list.0.display();
                Answer::Failed(format!("{name} is not a list of colliders, ties or levels of detail"))
            }
        });
    }
    // Textures of a glTF head's materials belong to the head.
    let heads = files.iter().filter(|(path, _)| has_ending(path, &["gltf"]));
    let heads: String = heads.map(|(_, bytes)| String::from_utf8_lossy(bytes)).collect();
    let mut rest: Vec<Read> =
        files.extract_if(.., |(path, _)| has_ending(path, &["png"]) && is_named(path, &heads)).collect();
    for file in files {
        if has_ending(&file.0, surroundings().kind.extensions()) {
            actions.push(put(surroundings(), file, Vec::new(), in_memory));
        } else if has_ending(&file.0, &["png"]) {
            let name = file.0.display().to_string();
            actions.push(Answer::Picture(name, shelf(vec![file], in_memory)));
        } else {
            rest.push(file);
        }
    }
    if !rest.is_empty() {
        actions.push(Answer::Open(hair(rest, in_memory)));
    }
    actions
}

/// Returns the action for files that the user chose for a companion.
pub fn for_companion(companion: &'static Companion, mut files: Vec<Read>, in_memory: bool) -> Answer {
    let endings = companion.kind.extensions();
    match files.iter().position(|(path, _)| has_ending(path, endings)) {
        Some(at) => {
            let file = files.swap_remove(at);
            put(companion, file, files, in_memory)
        }
        None => Answer::Failed(format!("{}: expected a .{} file", companion.title, endings.join(" or ."))),
    }
}

fn put(companion: &'static Companion, file: Read, mut with: Vec<Read>, in_memory: bool) -> Answer {
    let name = file.0.display().to_string();
    with.push(file);
    Answer::Companion(companion, name, shelf(with, in_memory))
}

fn surroundings() -> &'static Companion {
    companion("environment").unwrap_or(&COMPANION_FILES[COMPANION_FILES.len() - 1])
}

/// Returns which companion a .json file is.
fn what(bytes: &[u8]) -> Option<&'static Companion> {
    let list: serde_json::Value = serde_json::from_slice(bytes).ok()?;
    [("colliders", "colliders"), ("joints", "colliders"), ("ties", "ties"), ("levels", "lod_maps")]
        .into_iter()
        .find(|(field, _)| list.get(field).is_some())
        .and_then(|(_, key)| companion(key))
}

/// Whether `text` contains the file's name, literally or URL-encoded.
fn is_named(path: &Path, text: &str) -> bool {
    let Some(name) = path.file_name().map(|name| name.to_string_lossy()) else { return false };
    text.contains(&*name) || text.contains(&name.replace(' ', "%20"))
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().unwrap_or_default();
    endings.iter().any(|each| ending.eq_ignore_ascii_case(each))
}

fn shelf(files: Vec<Read>, in_memory: bool) -> Shelf {
    let mut shelf = Shelf::default();
    for (path, bytes) in files.into_iter().filter(|_| in_memory) {
        shelf.put(path, bytes);
    }
    shelf
}

/// Splits files into groom and head.
fn hair(files: Vec<Read>, in_memory: bool) -> Files {
    if in_memory {
        let given = files.into_iter().map(|(path, bytes)| (path, Cow::Owned(bytes))).collect();
        return Files::Given(Arc::new(given));
    }
    let (mut grooms, mut heads) = (Vec::<PathBuf>::new(), Vec::new());
    for (path, bytes) in files {
        match import::kind(&path, &bytes) {
            Some(FileKind::Mesh) => heads.push(path),
            Some(FileKind::Resource) => {}
            // For unknown files the groom reader reports the error.
            Some(FileKind::Groom) | None => grooms.push(path),
        }
    }
    Files::Disk { grooms, heads }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, text: &str) -> Read {
        (name.into(), text.as_bytes().to_vec())
    }

    #[test]
    fn dropped_files_are_sorted_by_kind() {
        let dropped = vec![
            read("far/sky.HDR", ""),
            read("far/d.png", ""),
            read("far/leaf.obj", "v 0 0 0\nf 1 1 1\n"),
            read("far/a.tfx", ""),
            read("far/c.json", r#"{"colliders": [{"shape": {"mesh": {"file": "leaf.obj"}}}]}"#),
        ];
        for in_memory in [false, true] {
            let answers = files(dropped.clone(), in_memory);
            let found = |is: &dyn Fn(&Answer) -> bool| answers.iter().filter(|a| is(a)).count();
            assert_eq!(answers.len(), 4, "{answers:?}");
            let sky = |a: &Answer| {
                matches!(a, Answer::Companion(c, name, files) if c.key == "environment"
                && name == "far/sky.HDR" && files.holds(Path::new("sky.HDR")) == in_memory)
            };
            assert_eq!(found(&sky), 1);
            let list = |a: &Answer| {
                matches!(a, Answer::Companion(c, _, files) if c.key == "colliders"
                && files.given().len() == if in_memory { 2 } else { 0 })
            };
            assert_eq!(found(&list), 1, "the mesh goes with the list that names it");
            assert_eq!(found(&|a| matches!(a, Answer::Picture(name, _) if name == "far/d.png")), 1);
            let groom = |a: &Answer| match a {
                Answer::Open(Files::Disk { grooms, heads }) => grooms.len() == 1 && heads.is_empty(),
                Answer::Open(Files::Given(files)) => files.len() == 1,
                _ => false,
            };
            assert_eq!(found(&groom), 1);
        }
    }

    #[test]
    fn gltf_head_includes_its_textures() {
        let head =
            read("far/head.gltf", r#"{"images": [{"uri": "my%20skin.png"}, {"uri": "maps/cut.png"}]}"#);
        let dropped = vec![read("my skin.png", "a"), head, read("cut.png", "b"), read("density.png", "c")];
        let answers = files(dropped, true);
        assert_eq!(answers.len(), 2, "{answers:?}");
        assert!(answers.iter().any(|a| matches!(a, Answer::Picture(name, _) if name == "density.png")));
        let names = answers.iter().find_map(|a| match a {
            Answer::Open(Files::Given(files)) => Some(files.iter().map(|(path, _)| path.clone()).collect()),
            _ => None,
        });
        let names: Vec<PathBuf> = names.expect("the head is opened");
        assert!(["far/head.gltf", "my skin.png", "cut.png"].iter().all(|name| names.contains(&name.into())));
    }

    #[test]
    fn preset_includes_its_files() {
        let answers = files(vec![read("d.png", "x"), read("look.toml", "version = 1")], true);
        assert!(matches!(&answers[..], [Answer::Preset(_, text, files)]
            if text == "version = 1" && files.holds(Path::new("d.png"))));
    }

    #[test]
    fn unusable_files_are_errors() {
        let said =
            |answer: &Answer, word: &str| matches!(answer, Answer::Failed(text) if text.contains(word));
        assert!(said(&files(vec![read("x.json", "{}")], false)[0], "x.json"));
        let curl = companion("curl_map").unwrap();
        assert!(said(&for_companion(curl, vec![read("a.tfx", "")], false), ".png"));
        let put = for_companion(curl, vec![read("a.tfx", ""), read("b.png", "")], true);
        assert!(matches!(put, Answer::Companion(c, name, _) if c == curl && name == "b.png"));
    }
}
