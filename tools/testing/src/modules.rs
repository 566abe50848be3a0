//! The module graph of a crate, for tests that fail on cycles.
//!
//! Sources are read as tokens, so comments, documentation links and strings are ignored. An arrow goes from one module
//! to another of the same folder if anything inside the first names anything inside the second, by `use` or by a path
//! in code. Names that `lib.rs` or a `mod.rs` re-exports count as the module that defines them. Test modules
//! (`#[cfg(test)]`) are ignored.

use proc_macro2::{TokenStream, TokenTree};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// A module path below the crate's root: `["light", "shadow"]`.
type Module = Vec<String>;

/// An arrow between two modules of a folder, with a place in the code that causes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrow {
    /// The module that names an item of `to`.
    pub from: String,
    /// The module that contains the item.
    pub to: String,
    /// The file, and the path that it names.
    pub because: String,
}

/// The modules of a crate and the paths that each names.
#[derive(Debug, Default)]
pub struct Modules {
    /// The paths that each module names. A path leads to a module or to an item of one.
    named: BTreeMap<Module, BTreeSet<Module>>,
    /// The path that a module re-exports under a name.
    exported: BTreeMap<(Module, String), Module>,
    files: BTreeMap<Module, PathBuf>,
}

impl Modules {
    /// Reads all modules below `root`, the file with the crate's root module (`lib.rs` or `main.rs`).
    ///
    /// # Panics
    /// When a file cannot be read or is not Rust.
    pub fn read(root: &Path) -> Self {
        let mut modules = Self::default();
        modules.file(root, Vec::new());
        modules
    }

    /// Returns the cycles between the modules of each folder as text: the arrows between modules that reach each other.
    /// Empty if there are none.
    pub fn report(&self) -> String {
        let line = |arrow: &Arrow| format!("  {} -> {}   ({})\n", arrow.from, arrow.to, arrow.because);
        let text = |arrows: Vec<Arrow>| format!("circle:\n{}", arrows.iter().map(line).collect::<String>());
        let folders: BTreeSet<&[String]> =
            self.files.keys().map(|module| &module[..module.len().saturating_sub(1)]).collect();
        folders.into_iter().filter_map(|folder| circle(self.arrows(folder))).map(text).collect()
    }

    /// Returns the arrows between the modules directly in `folder`.
    pub fn arrows(&self, folder: &[String]) -> Vec<Arrow> {
        let mut arrows: BTreeMap<(String, String), String> = BTreeMap::new();
        let depth = folder.len();
        for (module, paths) in &self.named {
            if module.len() <= depth || !module.starts_with(folder) {
                continue;
            }
            for path in paths {
                let to = self.resolve(path);
                if to.len() > depth && to.starts_with(folder) && to[depth] != module[depth] {
                    let target = to[..=depth].to_vec();
                    if !self.files.contains_key(&target) {
                        continue;
                    }
                    let because = format!("{}: {}", self.files[module].display(), path.join("::"));
                    let key = (module[..=depth].join("::"), target.join("::"));
                    arrows.entry(key).or_insert(because);
                }
            }
        }
        arrows.into_iter().map(|((from, to), because)| Arrow { from, to, because }).collect()
    }

    /// Follows re-exports. Returns the path of the module that defines `path`.
    fn resolve(&self, path: &[String]) -> Module {
        let mut path = path.to_vec();
        // A chain of re-exports ends. The bound is for a name that re-exports itself.
        for _ in 0..16 {
            let step = (0..path.len()).find_map(|i| {
                let to = self.exported.get(&(path[..i].to_vec(), path[i].clone()))?;
                let new = [&to[..], &path[i + 1..]].concat();
                (new != path).then_some(new)
            });
            match step {
                Some(new) => path = new,
                None => break,
            }
        }
        path
    }

    fn file(&mut self, path: &Path, module: Module) {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let tokens: TokenStream = text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        self.files.insert(module.clone(), path.to_path_buf());
        self.named.entry(module.clone()).or_default();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let folder = path.parent().unwrap_or(Path::new("."));
        let folder = match name {
            "lib.rs" | "main.rs" | "mod.rs" => folder.to_path_buf(),
            _ => path.with_extension(""),
        };
        self.items(tokens, &module, &folder);
    }

    fn items(&mut self, tokens: TokenStream, module: &Module, folder: &Path) {
        let tokens: Vec<_> = tokens.into_iter().collect();
        let (mut i, mut test) = (0, false);
        // The modules that are declared here, so that `use own::Thing` resolves to them.
        let own: BTreeSet<String> = tokens
            .windows(2)
            .filter(|pair| pair[0].to_string() == "mod")
            .map(|pair| pair[1].to_string())
            .collect();
        while i < tokens.len() {
            let word = tokens[i].to_string();
            let text = |k: usize| tokens.get(i + k).map(ToString::to_string).unwrap_or_default();
            if word == "#" {
                let inside = text(1).replace(' ', "");
                test |= inside.starts_with("[cfg(test") || inside.starts_with("[cfg(all(test");
                i += 2;
                continue;
            }
            match word.as_str() {
                "mod" if matches!(text(2).as_str(), ";") => {
                    let name = text(1);
                    if !test {
                        let mut inner = module.clone();
                        inner.push(name.clone());
                        let flat = folder.join(format!("{name}.rs"));
                        let file = if flat.exists() { flat } else { folder.join(&name).join("mod.rs") };
                        self.file(&file, inner);
                    }
                    (i, test) = (i + 3, false);
                }
                "mod" if matches!(tokens.get(i + 2), Some(TokenTree::Group(_))) => {
                    if let (false, Some(TokenTree::Group(group))) = (test, tokens.get(i + 2)) {
                        self.paths(group.stream(), module);
                    }
                    (i, test) = (i + 3, false);
                }
                "use" => {
                    let public = i > 0
                        && (tokens[i - 1].to_string() == "pub"
                            || i > 1 && tokens[i - 2].to_string() == "pub");
                    let end =
                        (i..tokens.len()).find(|k| tokens[*k].to_string() == ";").unwrap_or(tokens.len());
                    if !test {
                        let mut found = Vec::new();
                        tree(&tokens[i + 1..end], Vec::new(), &mut found);
                        for (path, name) in found {
                            let Some(path) = absolute(&path, module, &own) else { continue };
                            if public {
                                self.exported.insert((module.clone(), name), path.clone());
                            } else {
                                self.named.entry(module.clone()).or_default().insert(path);
                            }
                        }
                    }
                    (i, test) = (end + 1, false);
                }
                _ => {
                    // An item ends with a block or a semicolon. Under `cfg(test)`, all of its tokens are ignored.
                    let ends = word == ";"
                        || matches!(&tokens[i], TokenTree::Group(g) if g.delimiter() == proc_macro2::Delimiter::Brace);
                    if !test {
                        self.paths(std::iter::once(tokens[i].clone()).collect(), module);
                        if word == "crate" || word == "super" {
                            self.paths(tokens[i..tokens.len().min(i + 24)].iter().cloned().collect(), module);
                        }
                    }
                    if ends {
                        test = false;
                    }
                    i += 1;
                }
            }
        }
    }

    /// Collects the paths in code that begin with `crate` or `super`.
    fn paths(&mut self, tokens: TokenStream, module: &Module) {
        let tokens: Vec<_> = tokens.into_iter().collect();
        let mut i = 0;
        while i < tokens.len() {
            match &tokens[i] {
                TokenTree::Group(group) => self.paths(group.stream(), module),
                TokenTree::Ident(ident) if ident == "use" => {
                    let end =
                        (i..tokens.len()).find(|k| tokens[*k].to_string() == ";").unwrap_or(tokens.len());
                    let mut found = Vec::new();
                    tree(&tokens[i + 1..end], Vec::new(), &mut found);
                    for (path, _) in found {
                        if let Some(path) = absolute(&path, module, &BTreeSet::new()) {
                            self.named.entry(module.clone()).or_default().insert(path);
                        }
                    }
                    i = end;
                }
                TokenTree::Ident(ident) if ident == "crate" || ident == "super" => {
                    let mut path = vec![ident.to_string()];
                    let mut k = i + 1;
                    while let (Some(a), Some(b), Some(TokenTree::Ident(part))) =
                        (tokens.get(k), tokens.get(k + 1), tokens.get(k + 2))
                    {
                        if a.to_string() != ":" || b.to_string() != ":" {
                            break;
                        }
                        path.push(part.to_string());
                        k += 3;
                    }
                    if let Some(path) = absolute(&path, module, &BTreeSet::new()) {
                        self.named.entry(module.clone()).or_default().insert(path);
                    }
                    i = k - 1;
                }
                _ => {}
            }
            i += 1;
        }
    }
}

/// Collects the paths of a `use` tree, each with the name that it imports.
pub(crate) fn tree(tokens: &[TokenTree], prefix: Vec<String>, found: &mut Vec<(Vec<String>, String)>) {
    for part in tokens.split(|token| token.to_string() == ",") {
        let mut path = prefix.clone();
        let mut name = None;
        let mut k = 0;
        let mut leaf = !part.is_empty();
        while k < part.len() {
            match &part[k] {
                TokenTree::Group(group) => {
                    tree(&group.stream().into_iter().collect::<Vec<_>>(), path.clone(), found);
                    leaf = false;
                }
                TokenTree::Ident(ident) if ident == "as" => {
                    name = part.get(k + 1).map(ToString::to_string);
                    break;
                }
                TokenTree::Ident(ident) => path.push(ident.to_string()),
                TokenTree::Punct(punct) if punct.as_char() == '*' => name = Some("*".into()),
                _ => {}
            }
            k += 1;
        }
        if leaf {
            if path.last().is_some_and(|last| last == "self") && path.len() > 1 {
                path.pop();
            }
            let name = name.or_else(|| path.last().cloned()).unwrap_or_default();
            found.push((path, name));
        }
    }
}

/// Returns the path from the crate's root, or `None` if it leads out of the crate.
pub(crate) fn absolute(path: &[String], module: &Module, own: &BTreeSet<String>) -> Option<Module> {
    let mut at = match path.first()?.as_str() {
        "crate" => Vec::new(),
        "self" | "super" => module.clone(),
        first if own.contains(first) => [&module[..], &[first.to_string()]].concat(),
        _ => return None,
    };
    for part in &path[..1] {
        if part == "super" {
            at.pop();
        }
    }
    for part in &path[1..] {
        match part.as_str() {
            "super" => _ = at.pop(),
            part => at.push(part.to_string()),
        }
    }
    Some(at)
}

/// Returns the arrows that lie on a cycle, or `None` if there are none.
fn circle(arrows: Vec<Arrow>) -> Option<Vec<Arrow>> {
    let has_path = |start: &str, end: &str| {
        let (mut visited, mut next) = (BTreeSet::new(), vec![start]);
        while let Some(at) = next.pop() {
            if at == end {
                return true;
            }
            if visited.insert(at) {
                next.extend(arrows.iter().filter(|arrow| arrow.from == at).map(|arrow| arrow.to.as_str()));
            }
        }
        false
    };
    let on_circle = |arrow: &&Arrow| has_path(&arrow.to, &arrow.from);
    let found: Vec<_> = arrows.iter().filter(on_circle).cloned().collect();
    (!found.is_empty()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a crate that consists of these files.
    fn crate_of(name: &str, files: &[(&str, &str)]) -> Modules {
        let root = std::env::temp_dir().join(format!("tresses-modules-{}-{name}", std::process::id()));
        _ = fs::remove_dir_all(&root);
        for (path, text) in files {
            let path = root.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let modules = Modules::read(&root.join("lib.rs"));
        fs::remove_dir_all(&root).unwrap();
        modules
    }

    #[test]
    fn circles_are_found_through_reexports_and_paths_in_code() {
        let circle = [
            ("lib.rs", "mod a; mod b; mod c; pub use c::C;"),
            ("a.rs", "use crate::{b::{self, B}, C}; pub struct A;"),
            ("b.rs", "pub struct B; fn f() { crate::C::new() }"),
            ("c/mod.rs", "mod d; pub struct C;"),
            ("c/d.rs", "fn f(_: crate::a::A) {}"),
        ];
        let report = crate_of("circle", &circle).report();
        for edge in ["a -> b", "a -> c", "b -> c", "c -> a"] {
            assert!(report.contains(edge), "{edge} in {report}");
        }
    }

    #[test]
    fn tests_comments_and_own_modules_make_no_arrows() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "use crate::b::B; mod inner { pub struct X; }"),
            ("b.rs", "//! [`crate::a::A`]\n pub struct B; #[cfg(test)] mod tests { use crate::a::A; }"),
        ];
        assert_eq!(crate_of("none", &files).report(), "");
    }

    #[test]
    fn circles_inside_folders_are_found() {
        let files = [
            ("lib.rs", "mod a;"),
            ("a/mod.rs", "mod x; mod y;"),
            ("a/x.rs", "use super::y::Y; pub struct X;"),
            ("a/y.rs", "use super::x::X; pub struct Y;"),
        ];
        assert!(crate_of("nested", &files).report().contains("a::x -> a::y"));
    }
}
