//! Names in all crates: types are nouns with one meaning, files are named by terms of graphics.

use proc_macro2::{TokenStream, TokenTree};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Participles and verbs that do not end in "ed".
const IRREGULAR: &str = "Begun Bound Brought Built Chosen Done Drawn Found Given Gives Grown Held Hidden Kept Known Lit \
                         Lost Made Met Seen Sees Shown Shows Spent Taken Told Wound Worn";
/// Nouns that end in "ed".
const NOUNS: &str = "Seed Speed Bed";

/// Words for which graphics and programming have other terms. No file name contains one.
const FILE_WORDS: &str = "aim alone along answers apart aside ask asked asks bare begun beside beyond bring busy carried \
                          carries carry choose chosen deepen farthest few glow gone here its lay least lid looks \
                          made meet meets met middle most moved ours place places reach reaches rewind room said seen \
                          see sees share shares shine sight sunk taken than theirs there thing things told turn turned \
                          turns under unlike unrest usual wanted way ways whole worth";
/// Public types whose names occur in several crates, and why.
const SHARED_TYPES: &[(&str, &str)] = &[
    ("Error", "the error of each library, as is usual in Rust"),
    ("Result", "the result of each library, as is usual in Rust"),
    ("CardLevel", WRAPPED),
    ("Cards", WRAPPED),
    ("Finding", WRAPPED),
    ("Groom", WRAPPED),
    ("Motion", WRAPPED),
    ("Rig", WRAPPED),
    ("Settings", WRAPPED),
    ("Strands", WRAPPED),
];
const WRAPPED: &str = "the Python class wraps the library's type";

/// A declared type.
struct Type {
    name: String,
    is_public: bool,
}

fn is_participle(name: &str) -> bool {
    let is_one_word = name.chars().skip(1).all(|c| c.is_ascii_lowercase());
    let is_in = |list: &str| list.split_whitespace().any(|word| word == name);
    is_one_word && (is_in(IRREGULAR) || name.ends_with("ed") && !is_in(NOUNS))
}

fn types(tokens: TokenStream, found: &mut Vec<Type>) {
    let tokens: Vec<_> = tokens.into_iter().collect();
    let word = |i: usize| tokens.get(i).map(ToString::to_string).unwrap_or_default();
    for (i, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Group(group) => types(group.stream(), found),
            TokenTree::Ident(keyword)
                if ["struct", "enum", "union", "trait", "type"].iter().any(|word| keyword == word) =>
            {
                let is_public = i > 0 && word(i - 1) == "pub";
                let name = word(i + 1);
                if name.starts_with(|c: char| c.is_ascii_uppercase()) {
                    found.push(Type { name, is_public });
                }
            }
            _ => {}
        }
    }
}

fn files(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.map(|entry| entry.unwrap().path()) {
        match path.is_dir() {
            true => files(&path, extension, found),
            false if path.extension().is_some_and(|found| found == extension) => found.push(path),
            false => {}
        }
    }
}

/// The folders of all crates.
fn crates() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let all = ["crates", "apps", "bindings", "tools"].map(|folder| fs::read_dir(root.join(folder)).unwrap());
    all.into_iter().flatten().map(|entry| entry.unwrap().path()).collect()
}

/// The faults of the crate in `folder`, a line each.
fn faults(folder: &Path) -> Vec<String> {
    let (mut sources, mut shaders, mut faults) = (Vec::new(), Vec::new(), Vec::new());
    files(&folder.join("src"), "rs", &mut sources);
    files(&folder.join("src"), "wesl", &mut shaders);
    let mut public: BTreeMap<String, BTreeSet<PathBuf>> = BTreeMap::new();
    for path in sources {
        let mut found = Vec::new();
        types(fs::read_to_string(&path).unwrap().parse().unwrap(), &mut found);
        for Type { name, is_public } in found {
            if is_participle(&name) {
                faults.push(format!("{}: {name} is no noun", path.display()));
            }
            // `none.rs` replaces a module without its feature, and repeats the names.
            if is_public && !path.ends_with("none.rs") {
                public.entry(name).or_default().insert(path.clone());
            }
        }
    }
    for path in shaders {
        let text = fs::read_to_string(&path).unwrap();
        let names =
            text.lines().filter_map(|line| line.trim_start_matches("public ").strip_prefix("struct "));
        let names =
            names.filter_map(|rest| rest.split_whitespace().next()).filter(|name| is_participle(name));
        faults.extend(names.map(|name| format!("{}: {name} is no noun", path.display())));
    }
    // A type of a trait implementation or of a macro has no name of its own; the associated types of std repeat.
    for (name, files) in public.iter().filter(|(_, files)| files.len() > 1) {
        let files: Vec<_> = files.iter().map(|path| path.display().to_string()).collect();
        faults.push(format!("{name} is declared in {}", files.join(" and ")));
    }
    faults
}

#[test]
fn types_are_nouns_with_names_of_their_own() {
    let found: Vec<_> = crates().iter().flat_map(|folder| faults(folder)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn public_types_have_one_meaning() {
    let mut crates_of: BTreeMap<String, BTreeSet<PathBuf>> = BTreeMap::new();
    for folder in crates() {
        let mut sources = Vec::new();
        files(&folder.join("src"), "rs", &mut sources);
        for path in sources {
            let mut found = Vec::new();
            types(fs::read_to_string(&path).unwrap().parse().unwrap(), &mut found);
            for Type { name, .. } in found.into_iter().filter(|found| found.is_public) {
                crates_of.entry(name).or_default().insert(folder.clone());
            }
        }
    }
    assert!(crates_of.len() > 300, "{}", crates_of.len());
    let shared: BTreeSet<&str> =
        crates_of.iter().filter(|(_, crates)| crates.len() > 1).map(|(name, _)| name.as_str()).collect();
    let listed: BTreeSet<&str> = SHARED_TYPES.iter().map(|(name, _)| *name).collect();
    assert_eq!(
        shared, listed,
        "public types with one name in several crates, and the list of those that may"
    );
}

#[test]
fn files_are_named_by_terms() {
    let words: BTreeSet<&str> = FILE_WORDS.split_whitespace().collect();
    let mut found = Vec::new();
    for folder in crates() {
        for extension in ["rs", "wesl", "wgsl", "py", "js", "ts"] {
            files(&folder.join("src"), extension, &mut found);
        }
    }
    assert!(found.len() > 500, "{}", found.len());
    let stem = |path: &PathBuf| path.file_stem().unwrap().to_string_lossy().into_owned();
    found.retain(|path| stem(path).split('_').any(|word| words.contains(word)));
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn participles_and_repeated_names_are_found() {
    let folder = std::env::temp_dir().join(format!("tresses-names-{}", std::process::id()));
    fs::create_dir_all(folder.join("src/b")).unwrap();
    fs::write(
        folder.join("src/a.rs"),
        "pub struct Part; pub(crate) struct Row; struct Asked(Seed); mod m { pub enum Key {} }",
    )
    .unwrap();
    fs::write(folder.join("src/b/mod.rs"), "pub struct Part { row: u32 } struct Row; pub struct CachedZone;")
        .unwrap();
    fs::write(folder.join("src/b/c.wesl"), "struct Lit {\n}\nstruct Light {\n}\n").unwrap();
    let found = faults(&folder).join("\n");
    fs::remove_dir_all(&folder).unwrap();
    assert_eq!(found.lines().count(), 3, "{found}");
    for fault in ["Asked is no noun", "Lit is no noun", "Part is declared in"] {
        assert!(found.contains(fault), "{fault} is not in {found}");
    }
}
