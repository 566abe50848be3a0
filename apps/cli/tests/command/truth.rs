//! Validation against a path tracer, if the reference images are available.

use std::{path::PathBuf, process::Command};

/// Name of a ratio, and its largest deviation from 1.
type RatioBound = (&'static str, f64);

/// Returns a line for each ratio of a view or light that violates its bound.
fn broken(report: &serde_json::Value, list: &str, bounds: &[RatioBound]) -> Vec<String> {
    let rows = report[list].as_array().expect("a list of rows");
    assert!(!rows.is_empty(), "nothing was compared");
    let check = |row: &serde_json::Value, (what, most): &RatioBound| {
        let of = |whose: &str| row[whose][what].as_f64();
        let ratio = of("ours")? / of("reference")?;
        println!("{}: {what} {ratio:.3}", row["name"]);
        let kept = (1.0 - most..=1.0 + most).contains(&ratio);
        (!kept).then(|| format!("{}: {what} {ratio:.3}", row["name"]))
    };
    rows.iter().flat_map(|row| bounds.iter().filter_map(move |bound| check(row, bound))).collect()
}

#[test]
#[ignore = "proof"]
fn luminance_matches_the_path_tracer() {
    let Some(assets) = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from) else {
        assert!(std::env::var_os("TRESSES_REQUIRE_ASSETS").is_none(), "TRESSES_ASSETS is not set");
        return println!("skipped: TRESSES_ASSETS is not set");
    };
    let compare = |more: &[&str]| -> serde_json::Value {
        let mut tresses = Command::new(env!("CARGO_BIN_EXE_tresses"));
        tresses.arg("compare").arg(assets.join("../reference/scenes.json")).arg("--json").args(more);
        let out = tresses.output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        serde_json::from_slice(&out.stdout).unwrap()
    };
    let (views, lights) = ([("luminance", 0.1), ("skin", 0.06)], [("luminance", 0.06), ("skin", 0.05)]);
    let found = compare(&[]);
    let all = [broken(&found, "views", &views), broken(&found, "lights", &lights)].concat();
    assert!(all.is_empty(), "{all:#?}");
    // The bounds detect missing occlusion of ambient light by hair, and missing light reflected from hair onto skin.
    let off = compare(&["--only", "sintel_brunette", "--ambient", "off"]);
    assert!(!broken(&off, "lights", &lights).is_empty());
}
