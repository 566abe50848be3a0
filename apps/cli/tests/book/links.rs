//! Links between pages, and the table of contents.

use super::{Page, blocks, root};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Component, Path, PathBuf},
};

/// Returns the targets of all links and images in `text`, outside of blocks.
fn targets(text: &str) -> Vec<String> {
    let prose = prose(text);
    let parts = prose.split("](").skip(1);
    parts.filter_map(|part| Some(part.split_once(')')?.0.to_owned())).collect()
}

/// Returns `text` without its blocks.
fn prose(text: &str) -> String {
    let mut inside = false;
    let outside = |line: &&str| {
        let fence = line.trim_start().starts_with("```");
        inside ^= fence;
        !inside && !fence
    };
    text.lines().filter(outside).collect::<Vec<_>>().join("\n")
}

/// Returns the anchors of the headings of `text`, as forges and mdBook name them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text);
    let headings = headings
        .lines()
        .filter_map(|line| line.trim_start_matches('#').strip_prefix(' ').filter(|_| line.starts_with('#')));
    let kept = |c: char| c.is_alphanumeric() || "-_ ".contains(c);
    headings
        .map(|text| {
            text.to_lowercase().chars().filter(|c| kept(*c)).collect::<String>().trim().replace(' ', "-")
        })
        .collect()
}

/// Returns `path` without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut all = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => assert!(all.pop(), "{} leaves the repository", path.display()),
            Component::CurDir => {}
            part => all.push(part),
        }
    }
    all
}

#[test]
fn links_lead_to_files_and_headings() {
    let pages = Page::all();
    let anchors: BTreeMap<_, _> =
        pages.iter().map(|page| (PathBuf::from(&page.path), anchors(&page.text))).collect();
    let (root, mut broken) = (root(), Vec::new());
    for page in &pages {
        let here = Path::new(&page.path);
        for target in targets(&page.text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let path =
                if file.is_empty() { here.to_owned() } else { normal(&here.parent().unwrap().join(file)) };
            let known = anchor.is_empty() || anchors.get(&path).is_none_or(|all| all.contains(anchor));
            if !root.join(&path).exists() || !known {
                broken.push(format!("{}: {target}", page.path));
            }
        }
    }
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

#[test]
fn summary_lists_every_page_of_the_book() {
    let pages = Page::all();
    let summary = pages.iter().find(|page| page.path == "docs/SUMMARY.md").unwrap();
    let listed: BTreeSet<_> = targets(&summary.text).iter().map(|target| format!("docs/{target}")).collect();
    let research = |path: &str| path.starts_with("docs/research/") && path != "docs/research/README.md";
    let book = pages.iter().map(|page| page.path.clone()).filter(|path| path.starts_with("docs/"));
    let book = book.filter(|path| path != "docs/SUMMARY.md" && !research(path)).collect();
    assert_eq!(listed, book, "docs/SUMMARY.md and the files of docs/ differ");
}

#[test]
fn links_and_anchors_are_found() {
    let text = "# The `a` b\n[x](y.md#z) ![p](q.png)\n```sh\n# no [n](m)\n```\n";
    assert_eq!(targets(text), ["y.md#z", "q.png"]);
    assert_eq!(anchors(text), BTreeSet::from(["the-a-b".to_owned()]));
    assert_eq!(blocks::blocks(text).len(), 1);
}
