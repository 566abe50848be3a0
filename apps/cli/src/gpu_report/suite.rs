//! The library's tests on the GPU, by cargo.

use super::section::{Draft, cells};
use anyhow::{Context, Result, ensure};
use std::{path::Path, process::Command};

/// Runs the tests on the GPU, if this is the folder of the repository and cargo is installed.
pub fn measure(draft: &mut Draft) -> Result<()> {
    if !Path::new("crates/tresses/tests/gpu").is_dir() {
        draft.note("Not run: this is not the folder of the repository.");
        return Ok(());
    }
    let mut command = Command::new("cargo");
    command.args(["test", "--workspace", "--exclude", "tresses-web", "--test", "gpu", "--no-fail-fast"]);
    let Ok(output) = command.output() else {
        draft.note("Not run: cargo does not start.");
        return Ok(());
    };
    let text = String::from_utf8_lossy(&output.stdout);
    let results: Vec<_> = text.lines().filter_map(result).collect();
    for (name, result) in &results {
        draft.row("Tests", &["test", "result"], cells![name, result]);
    }
    let count = |outcome: &str| results.iter().filter(|(_, result)| *result == outcome).count();
    let failed: Vec<_> =
        results.iter().filter(|(_, result)| *result == "failed").map(|(name, _)| *name).collect();
    draft.note(format!("{} passed, {} failed, {} skipped.", count("passed"), failed.len(), count("skipped")));
    if !failed.is_empty() {
        draft.find(format!("tests failed: {}", failed.join(", ")));
        let details = text.split_once("\nfailures:\n").map_or("", |(_, details)| details);
        draft.note(details.chars().take(20_000).collect::<String>());
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    ensure!(!results.is_empty(), "cargo ran no test: {}", errors.lines().last().context("no message")?);
    Ok(())
}

/// Returns name and result of a test from a line of its output.
fn result(line: &str) -> Option<(&str, &'static str)> {
    let (name, result) = line.strip_prefix("test ")?.rsplit_once(" ... ")?;
    match result.split(',').next()? {
        "ok" => Some((name, "passed")),
        "FAILED" => Some((name, "failed")),
        "ignored" => Some((name, "skipped")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_tests_are_read() {
        assert_eq!(result("test a::b ... ok"), Some(("a::b", "passed")));
        assert_eq!(result("test a ... FAILED"), Some(("a", "failed")));
        assert_eq!(result("test a ... ignored, proof"), Some(("a", "skipped")));
        assert_eq!(result("test result: ok. 3 passed"), None);
    }
}
