//! The public types of a crate, for tests that limit how many there are.
//!
//! Sources are read as tokens, with all features on and without tests. Types that a macro declares are not found.

use crate::modules::{absolute, tree};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

/// A module path below the crate's root.
type Module = Vec<String>;

/// A module, type or import that a module declares.
#[derive(Debug)]
struct Item {
    /// The name in the declaring module; `*` for an import of all names.
    name: String,
    /// Whether the item is `pub`, without restriction.
    is_public: bool,
    kind: ItemKind,
}

#[derive(Debug)]
enum ItemKind {
    Module,
    Type,
    /// An import of this path of the crate.
    Import(Module),
}

/// The types that users of a crate can name: structs, enums, traits, unions and type aliases.
#[derive(Debug, Default)]
pub struct PublicTypes {
    /// The items of each module.
    items: BTreeMap<Module, Vec<Item>>,
    /// The public paths of each type, by the path of its declaration.
    found: BTreeMap<Module, BTreeSet<String>>,
}

impl PublicTypes {
    /// Reads the crate whose root module is the file `root`.
    ///
    /// # Panics
    /// When a file cannot be read or is not Rust.
    pub fn read(root: &Path) -> Self {
        let mut types = Self::default();
        types.file(root, Vec::new());
        types.visit(&Vec::new(), "", 0);
        types
    }

    /// The public paths of each type. A type that is re-exported twice has two.
    pub fn paths(&self) -> impl Iterator<Item = &BTreeSet<String>> {
        self.found.values()
    }

    fn file(&mut self, path: &Path, module: Module) {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let tokens = text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let is_folder = ["lib.rs", "mod.rs"].iter().any(|name| path.ends_with(name));
        let folder = if is_folder { path.with_file_name("") } else { path.with_extension("") };
        self.module(tokens, module, &folder);
    }

    /// Collects the items of `module`, whose submodules have their files in `folder`.
    fn module(&mut self, tokens: TokenStream, module: Module, folder: &Path) {
        let tokens: Vec<_> = tokens.into_iter().collect();
        let word = |i: usize| tokens.get(i).map(ToString::to_string).unwrap_or_default();
        let own: BTreeSet<String> =
            (0..tokens.len()).filter(|i| word(*i) == "mod").map(|i| word(i + 1)).collect();
        let mut items = Vec::new();
        let (mut i, mut is_public, mut is_skipped) = (0, false, false);
        while i < tokens.len() {
            let start = i;
            match word(i).as_str() {
                "#" => {
                    // An inner attribute has an exclamation mark.
                    i += usize::from(word(i + 1) == "!");
                    let attribute = word(i + 1).replace(' ', "");
                    is_skipped |= ["[cfg(test", "[cfg(all(test", "[cfg(not(feature"]
                        .iter()
                        .any(|skipped| attribute.starts_with(skipped));
                    i += 2;
                    continue;
                }
                "pub" => {
                    let is_restricted = matches!(tokens.get(i + 1), Some(TokenTree::Group(_)));
                    (i, is_public) = (i + 1 + usize::from(is_restricted), !is_restricted);
                    continue;
                }
                // Words before the keyword of an item.
                "unsafe" | "auto" => {
                    i += 1;
                    continue;
                }
                _ => {}
            }
            let end = (i..tokens.len()).find(|k| ends_item(&tokens[*k])).unwrap_or(tokens.len());
            let mut add = |name, kind| items.push(Item { name, is_public, kind });
            match word(i).as_str() {
                _ if is_skipped => {}
                "struct" | "enum" | "trait" | "union" | "type" => add(word(i + 1), ItemKind::Type),
                "mod" => {
                    let name = word(i + 1);
                    add(name.clone(), ItemKind::Module);
                    let inner = [&module[..], std::slice::from_ref(&name)].concat();
                    match &tokens[end] {
                        TokenTree::Group(group) => self.module(group.stream(), inner, &folder.join(name)),
                        _ => {
                            let flat = folder.join(format!("{name}.rs"));
                            let file = if flat.exists() { flat } else { folder.join(&name).join("mod.rs") };
                            self.file(&file, inner);
                        }
                    }
                }
                "use" => {
                    // Braces of a list do not end the item.
                    let end = (i..tokens.len()).find(|k| word(*k) == ";").unwrap_or(tokens.len());
                    let mut found = Vec::new();
                    tree(&tokens[i + 1..end], Vec::new(), &mut found);
                    for (path, name) in found {
                        if let Some(path) = absolute(&path, &module, &own) {
                            add(name, ItemKind::Import(path));
                        }
                    }
                    (i, is_public, is_skipped) = (end + 1, false, false);
                    continue;
                }
                _ => {}
            }
            (i, is_public, is_skipped) = (end.max(start) + 1, false, false);
        }
        self.items.entry(module).or_default().extend(items);
    }

    /// Adds the types that are public in `module`, which is public as `path`.
    fn visit(&mut self, module: &Module, path: &str, depth: usize) {
        // A module that re-exports one around it would never end.
        if depth > 8 {
            return;
        }
        let items: Vec<(String, Option<Module>)> = self.items.get(module).map_or(Vec::new(), |items| {
            let public = items.iter().filter(|item| item.is_public);
            let target = |item: &Item| match &item.kind {
                ItemKind::Import(path) => (item.name.clone(), Some(path.clone())),
                _ => (item.name.clone(), None),
            };
            public.map(target).collect()
        });
        for (name, import) in items {
            let declared = match import {
                Some(path) => self.resolve(&path, 0),
                None => Some([&module[..], std::slice::from_ref(&name)].concat()),
            };
            let Some(declared) = declared else { continue };
            match (name.as_str(), self.items.contains_key(&declared)) {
                ("*", true) => self.visit(&declared, path, depth + 1),
                (_, true) => self.visit(&declared, &format!("{path}{name}::"), depth + 1),
                _ if self.is_type(&declared) => {
                    self.found.entry(declared).or_default().insert(format!("{path}{name}"));
                }
                _ => {}
            }
        }
    }

    fn is_type(&self, path: &[String]) -> bool {
        let Some((name, module)) = path.split_last() else { return false };
        let items = self.items.get(module).into_iter().flatten();
        items.into_iter().any(|item| item.name == *name && matches!(item.kind, ItemKind::Type))
    }

    /// Follows imports to the declaration of `path`. `None` if it leads out of the crate.
    fn resolve(&self, path: &[String], depth: usize) -> Option<Module> {
        if self.items.contains_key(path) || self.is_type(path) {
            return Some(path.to_vec());
        }
        for i in 0..path.len().min(if depth < 16 { usize::MAX } else { 0 }) {
            for item in self.items.get(&path[..i]).into_iter().flatten() {
                let ItemKind::Import(target) = &item.kind else { continue };
                let target = match item.name.as_str() {
                    "*" => [&target[..], &path[i..]].concat(),
                    name if name == path[i] => [&target[..], &path[i + 1..]].concat(),
                    _ => continue,
                };
                if let Some(found) = (target != path).then(|| self.resolve(&target, depth + 1)).flatten() {
                    return Some(found);
                }
            }
        }
        None
    }
}

/// Whether an item ends with `token`: a semicolon or a block.
fn ends_item(token: &TokenTree) -> bool {
    match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        token => token.to_string() == ";",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the public paths of the types of a crate that consists of these files.
    fn paths(name: &str, files: &[(&str, &str)]) -> Vec<String> {
        let root = std::env::temp_dir().join(format!("tresses-public-{}-{name}", std::process::id()));
        _ = fs::remove_dir_all(&root);
        for (path, text) in files {
            let path = root.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let types = PublicTypes::read(&root.join("lib.rs"));
        fs::remove_dir_all(&root).unwrap();
        types.paths().map(|paths| paths.iter().cloned().collect::<Vec<_>>().join(" ")).collect()
    }

    #[test]
    fn only_types_with_a_public_path_are_found() {
        let files = [
            ("lib.rs", "//! Docs.\n mod a; pub mod b; pub use a::{A, inner::C as D}; pub use other::X; mod hidden { pub struct H; }"),
            (
                "a.rs",
                "pub struct A(pub u8); pub struct NotExported; pub(crate) struct B { b: u8 }
                 pub mod inner { pub enum C { Self1 } pub fn f() -> impl Fn() { || {} } }",
            ),
            (
                "b/mod.rs",
                "mod c; pub use self::c::*; pub unsafe trait T {} pub type L<T> = Vec<T>;
                 #[cfg(test)] pub struct Test; #[cfg(not(feature = \"f\"))] pub struct Without;
                 #[cfg(feature = \"f\")] #[derive(Debug)] pub union U { a: u8 } impl X { pub const Y: u8 = { 1 }; type Z = u8; }",
            ),
            ("b/c.rs", "use crate::a::B; pub(super) struct P; pub struct Q; struct R;"),
        ];
        assert_eq!(paths("visible", &files), ["A", "D", "b::L", "b::T", "b::U", "b::Q"]);
    }

    #[test]
    fn second_paths_and_imports_of_imports_are_found() {
        let files = [
            (
                "lib.rs",
                "pub mod a; pub use a::A; pub mod low { pub use crate::a::B; pub mod c { pub use crate::c::*; } } mod c;",
            ),
            ("a.rs", "mod b; pub struct A; pub(crate) use b::B;"),
            ("a/b.rs", "pub struct B;"),
            ("c.rs", "pub(crate) use crate::a::A; pub use crate::a::A as E; pub struct C;"),
        ];
        assert_eq!(paths("twice", &files), ["A a::A low::c::E", "low::B", "low::c::C"]);
    }
}
