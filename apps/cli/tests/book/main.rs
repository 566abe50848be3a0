//! The documentation: blocks of code run or are quoted from code that runs, and links lead somewhere.

mod blocks;
mod links;
mod shell;

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Returns the repository's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// A Markdown file.
struct Page {
    /// Path from the repository's folder, with `/`.
    path: String,
    text: String,
}

impl Page {
    /// Reads all Markdown files of the repository.
    fn all() -> Vec<Self> {
        let root = root();
        let mut pages = Vec::new();
        collect(&root, &root, &mut pages);
        pages.sort_by(|a, b| a.path.cmp(&b.path));
        assert!(pages.iter().any(|page| page.path == "docs/SUMMARY.md"), "the book is missing");
        pages
    }

    /// Reads the pages that teach: guide, reference, and the README of each package.
    fn taught() -> Vec<Self> {
        let mut pages = Self::all();
        let book = |path: &str| path.starts_with("docs/guide/") || path.starts_with("docs/reference/");
        pages.retain(|page| {
            page.path.ends_with("README.md") && page.path != "docs/research/README.md" || book(&page.path)
        });
        pages
    }
}

/// Adds the Markdown files below `folder`, without hidden folders and build outputs.
fn collect(root: &Path, folder: &Path, pages: &mut Vec<Page>) {
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let (path, name) = (entry.path(), entry.file_name().into_string().unwrap());
        let built = ["target", "out", "dist", "dist-viewer", "node_modules", "book"].contains(&name.as_str());
        if path.is_dir() && !name.starts_with('.') && !built {
            collect(root, &path, pages);
        } else if name.ends_with(".md") {
            let relative = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
            pages.push(Page { path: relative, text: fs::read_to_string(&path).unwrap() });
        }
    }
}
