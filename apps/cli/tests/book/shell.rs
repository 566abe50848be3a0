//! Shell lines of the documentation.

use super::{Page, blocks::blocks};
use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

/// Returns the words of a line that runs `tresses`, without redirections.
fn arguments(line: &str) -> Option<Vec<String>> {
    let mut words = shlex::split(line)?;
    let end = words.iter().position(|word| ["|", ">", ">>", "&&", ";"].contains(&word.as_str()));
    words.truncate(end.unwrap_or(words.len()));
    (words.first()? == "tresses").then_some(words)
}

#[test]
fn commands_have_valid_options() {
    let mut count = 0;
    for page in Page::taught() {
        for block in blocks(&page.text) {
            if !["sh", "console"].contains(&block.language) {
                continue;
            }
            for line in block.lines.iter().map(|line| line.trim()) {
                let Some(words) = arguments(line) else { continue };
                count += 1;
                if let Err(problem) = tresses_cli::check(&words) {
                    panic!("{}: {line}\n{problem}", page.path);
                }
            }
        }
    }
    assert!(count > 50, "only {count} commands were found");
}

/// Runs the shell blocks of each page in a folder with the sample files.
#[test]
#[ignore = "proof"]
fn shell_blocks_run() {
    let home = tempfile::tempdir().unwrap();
    let samples = home.path().join("samples");
    let command = Path::new(env!("CARGO_BIN_EXE_tresses"));
    let made = Command::new(command).arg("sample").arg(&samples).output().unwrap();
    let said = String::from_utf8_lossy(&made.stderr).into_owned();
    if tresses_testing::lacks_gpu(&said) {
        return;
    }
    assert!(made.status.success(), "{said}");
    let path = format!("{}:{}", command.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let mut failed = Vec::new();
    for page in Page::taught() {
        let folder = home.path().join(page.path.replace('/', "-"));
        fs::create_dir(&folder).unwrap();
        for file in fs::read_dir(&samples).unwrap().map(Result::unwrap) {
            fs::copy(file.path(), folder.join(file.file_name())).unwrap();
        }
        for block in blocks(&page.text) {
            if let Some(name) = block.file {
                fs::write(folder.join(name), block.lines.join("\n")).unwrap();
            }
            if block.language != "sh" {
                continue;
            }
            for line in block.lines.iter().filter(|line| !line.trim().is_empty()) {
                let shell = Command::new("bash")
                    .args(["-euo", "pipefail", "-c", line])
                    .current_dir(&folder)
                    .env("PATH", &path)
                    .stdin(Stdio::null())
                    .output()
                    .unwrap();
                if !shell.status.success() {
                    failed.push(format!(
                        "{}: {line}\n  {}",
                        page.path,
                        String::from_utf8_lossy(&shell.stderr)
                    ));
                }
            }
        }
        fs::remove_dir_all(&folder).unwrap();
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
