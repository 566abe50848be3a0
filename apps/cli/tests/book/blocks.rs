//! Fenced blocks of code.

use super::{Page, root};
use std::fs;

/// A fenced block.
pub struct Block<'a> {
    pub language: &'a str,
    /// Name of the file that the block shows, if it has one.
    pub file: Option<&'a str>,
    /// Line of the block's fence, counted from 1.
    pub line: usize,
    pub lines: Vec<&'a str>,
}

/// Languages, and how their blocks are tested.
///
/// `sh` runs (`shell.rs`), `python` runs in the tests of the Python wheel, `json` and `toml` are parsed. `rust`,
/// `html`, `js` and `wgsl` must be quoted from tested code. `console` and `text` are not tested.
const LANGUAGES: [&str; 10] =
    ["sh", "console", "python", "json", "toml", "rust", "html", "js", "wgsl", "text"];

/// Folders with code that tests compile and run, from which pages quote.
const QUOTED_FOLDERS: [&str; 7] = [
    "crates/tresses/examples",
    "crates/tresses/src",
    "crates/tresses/tests/gpu",
    "bindings/bevy/examples",
    "bindings/bevy/tests/headless",
    "apps/web/component",
    "apps/web/tests/page/viewer",
];

/// Returns the fenced blocks of `text`.
pub fn blocks(text: &str) -> Vec<Block<'_>> {
    let mut all = Vec::new();
    let mut open: Option<Block<'_>> = None;
    for (i, line) in text.lines().enumerate() {
        let Some(info) = line.trim_start().strip_prefix("```") else {
            if let Some(block) = &mut open {
                block.lines.push(line);
            }
            continue;
        };
        match open.take() {
            Some(block) => all.push(block),
            None => {
                let (language, file) =
                    info.split_once(' ').map_or((info, None), |(language, file)| (language, Some(file)));
                open = Some(Block { language, file, line: i + 1, lines: Vec::new() });
            }
        }
    }
    assert!(open.is_none(), "a block does not end");
    all
}

/// Returns `lines` without empty ones, surrounding spaces, and the marks and hidden lines of tested doc comments.
fn normalize<'a>(lines: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let lines = lines.into_iter().map(|line| {
        let line = line.trim();
        line.strip_prefix("//!").or(line.strip_prefix("///")).unwrap_or(line).trim()
    });
    lines.filter(|line| !line.is_empty() && *line != "#" && !line.starts_with("# ")).collect()
}

#[test]
fn blocks_have_a_known_language() {
    for page in Page::taught() {
        for block in blocks(&page.text) {
            let is_known = LANGUAGES.contains(&block.language);
            assert!(
                is_known,
                "{}:{}: a block of {:?}: use one of {LANGUAGES:?}",
                page.path, block.line, block.language
            );
        }
    }
}

#[test]
fn data_blocks_parse() {
    for page in Page::taught() {
        for block in blocks(&page.text) {
            let text = block.lines.join("\n");
            let problem = match block.language {
                "json" => serde_json::from_str::<serde_json::Value>(&text).err().map(|e| e.to_string()),
                "toml" => toml::from_str::<toml::Table>(&text).err().map(|e| e.to_string()),
                _ => None,
            };
            assert!(problem.is_none(), "{}:{}: {}", page.path, block.line, problem.unwrap());
        }
    }
}

#[test]
fn code_blocks_are_quoted_from_tested_code() {
    let mut sources = Vec::new();
    for folder in QUOTED_FOLDERS {
        read_files(&root().join(folder), &mut sources);
    }
    let sources: Vec<_> = sources.iter().map(|text| normalize(text.lines())).collect();
    let mut missing = Vec::new();
    for page in Page::taught() {
        for block in blocks(&page.text) {
            let lines = normalize(block.lines.iter().copied());
            if ["rust", "html", "js", "wgsl"].contains(&block.language)
                && !sources.iter().any(|source| source.windows(lines.len()).any(|part| part == lines))
            {
                missing.push(format!("{}:{}", page.path, block.line));
            }
        }
    }
    assert!(missing.is_empty(), "blocks that are not quoted from {QUOTED_FOLDERS:?}: {missing:?}");
}

/// Appends the text of all files below `folder` to `texts`.
fn read_files(folder: &std::path::Path, texts: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() {
            read_files(&entry.path(), texts);
        } else {
            texts.extend(fs::read_to_string(entry.path()));
        }
    }
}

#[test]
fn blocks_are_found() {
    let found = blocks("a\n```sh\nls # b\n\n```\n```json x.json\n{}\n```\n");
    assert_eq!(
        found.iter().map(|b| (b.language, b.file, b.line)).collect::<Vec<_>>(),
        [("sh", None, 2), ("json", Some("x.json"), 6)]
    );
    assert_eq!(found[0].lines, ["ls # b", ""]);
}
