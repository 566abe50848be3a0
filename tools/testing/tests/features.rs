//! Features of dependencies. If two selections of packages enable different ones, Cargo compiles most of the tree twice.

use std::{collections::BTreeSet, process::Command};

/// Returns the dependencies that Cargo selects with `arguments`, each with its version and features.
fn selected(arguments: &[&str]) -> BTreeSet<String> {
    let mut command = Command::new(env!("CARGO"));
    command.args(["tree", "--locked", "--prefix", "none", "--format", "{p} {f}"]);
    let output = command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| line.trim_end_matches(" (*)").to_owned())
        .collect()
}

/// Tests of the workspace, tests without the page's builder, and the programs share compiled dependencies.
#[test]
fn shared_features() {
    let all = selected(&["--workspace"]);
    assert!(all.len() > 300, "{}", all.len());
    for selection in
        [&["--workspace", "--exclude", "tresses-web"][..], &["--workspace", "--edges", "normal,build"]]
    {
        let other = selected(selection);
        let differ: Vec<_> = other.difference(&all).collect();
        assert!(
            differ.is_empty(),
            "{selection:?} selects other features; add the missing ones to tools/evidence/Cargo.toml: {differ:#?}"
        );
    }
    assert!(!selected(&["--package", "tresses-groom"]).is_subset(&all), "a package alone has fewer features");
}
