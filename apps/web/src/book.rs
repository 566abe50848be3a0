//! Builds the book from `docs/`.

use anyhow::{Context, Result, bail, ensure};
use std::{
    fs,
    path::{Component, Path, PathBuf},
    process::Command,
};

/// Address of the files that pages link to outside of `docs/`.
pub const FILES: &str = concat!(env!("CARGO_PKG_REPOSITORY"), "/blob/main/");

/// Builds the book into `out` with the program `mdbook`. Links that leave `docs/` lead to the repository.
///
/// # Errors
/// Fails if mdBook warns, and if files cannot be read or written.
pub fn build_book(mdbook: &Path, out: &Path) -> Result<()> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").canonicalize()?;
    let pages = tempfile::tempdir()?;
    copy(&docs, &docs, pages.path())?;
    let out = std::path::absolute(out)?;
    let mut command = Command::new(mdbook);
    let output = command.arg("build").arg(pages.path()).arg("--dest-dir").arg(&out).output();
    let output = output.with_context(|| format!("cannot start {}", mdbook.display()))?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    let problem = stderr.lines().find(|line| line.contains("WARN") || line.contains("ERROR"));
    if let Some(problem) = problem {
        bail!("mdBook: {problem}");
    }
    ensure!(output.status.success(), "mdBook: {stderr}");
    Ok(())
}

/// Copies the files of `folder`, which lies in `docs`, to the same places in `to`.
fn copy(docs: &Path, folder: &Path, to: &Path) -> Result<()> {
    let into = to.join(folder.strip_prefix(docs)?);
    fs::create_dir_all(&into)?;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let (path, target) = (entry.path(), into.join(entry.file_name()));
        if path.is_dir() {
            copy(docs, &path, to)?;
        } else if path.extension().is_some_and(|extension| extension == "md") {
            let within = Path::new("docs").join(folder.strip_prefix(docs)?);
            fs::write(target, with_addresses(&fs::read_to_string(&path)?, &within))?;
        } else {
            fs::copy(path, target)?;
        }
    }
    Ok(())
}

/// Returns `text`, a page in `folder`, with the repository's address in links to files outside of `docs/`.
pub fn with_addresses(text: &str, folder: &Path) -> String {
    let mut parts = text.split("](");
    let mut all = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        all.push_str("](");
        let target = part.split(')').next().unwrap_or_default();
        let file = target.split('#').next().unwrap_or_default();
        match outside(folder, file).filter(|_| !file.is_empty() && !target.contains("://")) {
            Some(path) => {
                all += FILES;
                all += &path;
                all += &part[file.len()..];
            }
            None => all += part,
        }
    }
    all
}

/// Returns the path from the repository's folder of `file`, seen from `folder`, if it lies outside of `docs/`.
fn outside(folder: &Path, file: &str) -> Option<String> {
    let mut path = PathBuf::new();
    for part in folder.join(file).components() {
        match part {
            Component::ParentDir => drop(path.pop()),
            part => path.push(part),
        }
    }
    (!path.starts_with("docs")).then(|| path.to_string_lossy().replace('\\', "/"))
}
