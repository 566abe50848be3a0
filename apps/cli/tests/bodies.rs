//! Hair on bodies that bend, from outside. The bodies are in the optional assets.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

fn tresses(folder: &Path, args: &[&str]) -> (bool, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_tresses")).current_dir(folder).args(args).output().unwrap();
    (out.status.success(), String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned())
}

/// The assets' files, where there are some.
fn assets() -> Option<PathBuf> {
    let found = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from).filter(|path| path.exists());
    let required = std::env::var_os("TRESSES_REQUIRE_ASSETS").is_some_and(|v| v == "1");
    assert!(found.is_some() || !required, "there are no assets");
    found
}

#[test]
fn a_head_that_cannot_move_says_so() {
    let folder = tempfile::tempdir().unwrap();
    for (args, why) in [
        (["--animation", "Walk"], "it has none of its own; --motion has nod"),
        (["--morph", "Angry=1"], "Breath, Jaw, Brows"),
    ] {
        let (done, said) = tresses(folder.path(), &[&["render", "--strands", "50"], &args[..]].concat());
        if !done && said.contains("adapter") {
            assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none(), "{said}");
            return println!("skipped: {said}");
        }
        assert!(!done && said.contains(why), "{said}");
    }
    for weight in ["Angry", "Angry=much", "=1", "Angry=1e9"] {
        let (done, said) = tresses(folder.path(), &["render", "--morph", weight]);
        assert!(!done && said.contains("--morph"), "{weight}: {said}");
    }
}

#[test]
fn a_robot_dances_with_hair_on() {
    let Some(assets) = assets() else { return println!("skipped: TRESSES_ASSETS is not set") };
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| assets.join(name).to_str().unwrap().to_owned();
    let groom = file("sintel_lite21/GEO-sintel_hair_emit.001-sintel_hair.tfx");
    let body = file("characters/RobotExpressive.glb");
    let base = ["render", &groom, "--head", &body, "--head-unit", "0.12", "--size", "96x96"];
    let take = |args: &[&str], out: &str| {
        let (done, said) = tresses(folder.path(), &[&base, args, &["--out", out]].concat());
        (done, said, std::fs::read(folder.path().join(out)).unwrap_or_default())
    };
    let (done, said, angry) = take(&["--morph", "Angry=1"], "angry.png");
    if !done && said.contains("adapter") {
        assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none(), "{said}");
        return println!("skipped: {said}");
    }
    assert!(done, "{said}");
    let (done, said, dances) = take(&["--animation", "dance", "--frames", "4"], "dance.png");
    assert!(done && dances != angry && !dances.is_empty(), "{said}");
    let (done, said, _) = take(&["--animation", "Knit"], "no.png");
    assert!(!done && said.contains("\"Knit\"; it has") && said.contains("Dance"), "{said}");
    assert!(!folder.path().join("no.png").exists());
}
