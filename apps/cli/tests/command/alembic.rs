//! Alembic and USD files, checked with Blender and the reference implementations.
//!
//! `TRESSES_BPY` names a Python with the module `bpy` (Debian's Blender is built without Alembic), `TRESSES_ALEMBIC`
//! one with `alembic3d`, and `TRESSES_USD` one with `pxr`. Without `TRESSES_BPY` the tests look for Blender. Tests
//! whose program is missing are skipped.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

const STRANDS: u64 = 600;
const POINTS: u64 = 9;

fn tresses(folder: &Path, args: &[&str]) -> String {
    let out = crate::output(folder, args);
    assert!(out.status.success(), "{args:?}: {}", crate::stderr(&out));
    String::from_utf8_lossy(&out.stdout).into_owned()
}

fn info(folder: &Path, args: &[&str]) -> Value {
    serde_json::from_str(&tresses(folder, &[&["info", "--json"], args].concat())).unwrap()
}

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name)
}

/// Runs the script in Blender and returns its output, or `None` without a Blender that supports Alembic.
fn blender(folder: &Path, words: &[&str]) -> Option<String> {
    let script = script("blender_grooms.py");
    let mut run = match std::env::var_os("TRESSES_BPY") {
        Some(python) => {
            let mut run = Command::new(python);
            run.arg(script);
            run
        }
        None => {
            let mut run = Command::new("blender");
            run.args(["--background", "--factory-startup", "--python"]).arg(script).arg("--");
            run
        }
    };
    let out = run.current_dir(folder).args(words).output().ok()?;
    let said = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
    if said.contains("alembic_export\" could not be found")
        || said.contains("alembic_import\" could not be found")
        // Before version 3.5, scripts cannot create hair.
        || said.contains("no attribute 'add_curves'")
    {
        return None;
    }
    assert!(out.status.success(), "{said}");
    Some(said)
}

/// Returns what Blender reads from a file: curves, points and the sum of all coordinates, in three frames.
fn found(folder: &Path, file: &str) -> Option<Value> {
    let said = blender(folder, &["count", file])?;
    let line = said.lines().find_map(|line| line.strip_prefix("FOUND ")).unwrap_or_else(|| panic!("{said}"));
    Some(serde_json::from_str(line).unwrap())
}

/// Returns the sum of all coordinates of the lines in an `.obj`.
fn sum(obj: &Path) -> [f64; 3] {
    sum_of_every(1, 1, obj)
}

/// Returns the sum over every `step`th point of lines of `points` points each.
fn sum_of_every(step: usize, points: usize, obj: &Path) -> [f64; 3] {
    let text = std::fs::read_to_string(obj).unwrap();
    let mut sum = [0.0; 3];
    let lines = text.lines().filter_map(|line| line.strip_prefix("v ")).enumerate();
    for (_, line) in lines.filter(|(i, _)| (i % points).is_multiple_of(step)) {
        for (sum, word) in sum.iter_mut().zip(line.split(' ')) {
            *sum += word.parse::<f64>().unwrap();
        }
    }
    sum
}

/// Whether two sums of `points` positions belong to the same curves, to a micrometer per point.
fn same(a: [f64; 3], b: &Value, points: u64) -> bool {
    a.iter().enumerate().all(|(k, a)| (a - b[k].as_f64().unwrap()).abs() < 1e-6 * points as f64)
}

#[test]
#[ignore = "proof"]
fn hair_from_blender_is_upright_and_complete() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    if blender(folder, &["make", "."]).is_none() {
        return println!("skipped: no Blender with Alembic");
    }
    let curves = info(folder, &["curves.abc"]);
    assert_eq!((&curves["strands"], &curves["vertices"]), (&STRANDS.into(), &(STRANDS * POINTS).into()));
    assert_eq!(curves["groom_placement"]["up"], "y");
    assert_eq!(curves["groom_placement"]["front"], "z");
    assert_eq!(curves["groom_placement"]["meters_per_unit"], 1.0);
    // Radius 50 µm at the root, 20 µm at the tip.
    let radius = |which: &str| curves["radius_m"][which].as_f64().unwrap();
    assert!((radius("max") - 5e-5).abs() < 1e-8 && (radius("min") - 2e-5).abs() < 1e-8, "{curves}");
    // The same groom with the head in the same file.
    let with_head = info(folder, &["curves.abc", "--head", "curves.abc"]);
    assert!(with_head["root_distance_m"]["median"].as_f64().unwrap() < 5e-4, "{with_head}");
    assert_eq!(with_head["groom_placement"]["up"], "y");
    let particles = info(folder, &["particles.abc", "--head", "particles.abc"]);
    assert_eq!(particles["strands"], 3000, "300 hairs of 10 children each");
    assert_eq!(particles["has"]["root_uvs"], true);
    assert_eq!(
        (&particles["groom_placement"]["up"], &particles["groom_placement"]["front"]),
        (&"y".into(), &"z".into())
    );
    let last = info(folder, &["particles.abc", "--frame", "2"]);
    assert_eq!(last["strands"], 3000);

    // The other direction: Blender reads our files.
    tresses(folder, &["convert", "curves.abc", "ours.abc"]);
    tresses(folder, &["convert", "curves.abc", "ours.obj"]);
    let Some(opened) = found(folder, "ours.abc") else { return };
    let (count, points) = (opened[0]["curves"].as_u64(), opened[0]["points"].as_u64());
    assert_eq!((count, points), (Some(STRANDS), Some(STRANDS * POINTS)));
    let ours = sum(&folder.join("ours.obj"));
    assert!(same(ours, &opened[0]["sum"], STRANDS * POINTS), "{ours:?} {opened}");
    assert!(
        !same([ours[0] + 0.01, ours[1], ours[2]], &opened[0]["sum"], STRANDS * POINTS),
        "tells what differs"
    );
    let width = opened[0]["width"].as_f64().unwrap();
    assert!((width - 7e-5).abs() < 1e-7, "mean of 100 and 40 µm: {width}");
    tresses(folder, &["convert", "curves.abc", "ours.usda"]);
    let Some(usd) = found(folder, "ours.usda") else { return };
    assert_eq!(usd[0]["curves"].as_u64(), Some(STRANDS));
    assert!(same(ours, &usd[0]["sum"], STRANDS * POINTS), "{ours:?} {usd}");
}

#[test]
#[ignore = "proof"]
fn blender_plays_the_cache_as_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // At half a meter per second, frames differ by far more than a micrometer.
    let hair = ["bake", "--style", "bob", "--strands", "500", "--out", "a.abc"];
    let args = [&hair[..], &["--motion", "shake", "--frames", "4"]].concat();
    let Some((_, said)) = crate::drawn(folder, &args) else { return };
    assert!(said.contains("4 frames of 500 strands"), "{said}");
    let bits = std::fs::read(folder.join("a.abc")).unwrap();
    tresses(folder, &args);
    assert!(bits == std::fs::read(folder.join("a.abc")).unwrap(), "two runs are one file");
    let frame = |number: &str| {
        tresses(folder, &["convert", "a.abc", "a.obj", "--as-is", "--frame", number]);
        sum(&folder.join("a.obj"))
    };
    let frames = ["0", "1", "2"].map(frame);
    let Some(opened) = found(folder, "a.abc") else { return println!("skipped: no Blender with Alembic") };
    for (i, sum) in frames.iter().enumerate() {
        let points = opened[i]["points"].as_u64().unwrap();
        assert!(same(*sum, &opened[i]["sum"], points), "frame {i}: {sum:?} {opened}");
        assert!(!same(*sum, &opened[(i + 1) % 3]["sum"], points), "frames differ");
    }
}

#[test]
#[ignore = "proof"]
fn reference_alembic_reads_our_files() {
    let Some(python) = std::env::var_os("TRESSES_ALEMBIC") else {
        return println!("skipped: TRESSES_ALEMBIC is not set");
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |name: &str, args: &[&str]| {
        let out = Command::new(&python).arg(script(name)).current_dir(folder).args(args).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8_lossy(&out.stdout).into_owned()
    };
    run("reference.py", &["write", "theirs.abc"]);
    tresses(folder, &["convert", "theirs.abc", "ours.abc", "--unit", "cm", "--up", "y", "--out-unit", "cm"]);
    let read: Value = serde_json::from_str(&run("reference.py", &["read", "ours.abc"])).unwrap();
    assert_eq!(read["curves"], 7);
    let attributes = &read["attributes"];
    assert_eq!(attributes["groom_guide"], serde_json::json!([0, 0, 0, 0, 0, 1, 1]));
    assert_eq!(attributes["groom_id"], serde_json::json!([0, 1, 2, 3, 4, 100, 101]));
    assert_eq!(attributes["groom_group_id"], serde_json::json!([0, 1, 0, 1, 0, 0, 1]));
    assert_eq!(attributes["groom_version_minor"], serde_json::json!([5]));
    assert_eq!(attributes["groom_width"].as_array().unwrap().len() as u64, read["points"].as_u64().unwrap());
    assert_eq!(read["times"], serde_json::json!([0.0]));
}

#[test]
#[ignore = "proof"]
fn usd_from_blender_is_upright_and_complete() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    if blender(folder, &["make", "."]).is_none() {
        return println!("skipped: no Blender with Alembic");
    }
    tresses(folder, &["convert", "curves.abc", "abc.obj"]);
    let meant = sum(&folder.join("abc.obj"));
    for file in ["curves.usda", "curves.usdc", "curves.usdz"] {
        let curves = info(folder, &[file]);
        // Eight Catmull-Rom segments, four steps each.
        assert_eq!((&curves["strands"], &curves["vertices"]), (&STRANDS.into(), &(STRANDS * 33).into()));
        assert_eq!(curves["groom_placement"]["up"], "z", "{curves}");
        assert_eq!(curves["groom_placement"]["front"], "-y", "{curves}");
        assert_eq!(curves["groom_placement"]["meters_per_unit"], 1.0);
        let radius = |which: &str| curves["radius_m"][which].as_f64().unwrap();
        assert!((radius("max") - 5e-5).abs() < 1e-8 && (radius("min") - 2e-5).abs() < 1e-8, "{curves}");
        let with_head = info(folder, &[file, "--head", file]);
        assert!(with_head["root_distance_m"]["median"].as_f64().unwrap() < 5e-4, "{with_head}");
        // Through the points of the Alembic file.
        tresses(folder, &["convert", file, "usd.obj"]);
        let [ours, other] = [4, 8].map(|step| sum_of_every(step, 33, &folder.join("usd.obj")));
        let near =
            |sum: [f64; 3]| (0..3).all(|k| (sum[k] - meant[k]).abs() < 1e-6 * (STRANDS * POINTS) as f64);
        assert!(near(ours) && !near(other), "{file}: {ours:?} {meant:?}");
    }
    // Blender does not export children to USD.
    let particles = info(folder, &["particles.usda", "--head", "particles.usda"]);
    assert_eq!(particles["strands"], 300);
    assert_eq!(particles["groom_placement"]["up"], "z");
    assert_eq!(particles["groom_placement"]["meters_per_unit"], 1.0, "{particles}");
}

#[test]
#[ignore = "proof"]
fn pixar_usd_reads_our_files() {
    let Some(python) = std::env::var_os("TRESSES_USD") else {
        return println!("skipped: TRESSES_USD is not set");
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |args: &[&str]| {
        let out = Command::new(&python)
            .arg(script("reference_usd.py"))
            .current_dir(folder)
            .args(args)
            .output()
            .unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8_lossy(&out.stdout).into_owned()
    };
    run(&["write", "theirs.usdc"]);
    tresses(folder, &["convert", "theirs.usdc", "ours.usda", "--front", "z", "--out-unit", "cm"]);
    tresses(folder, &["convert", "theirs.usdc", "ours.obj", "--front", "z"]);
    let read: Value = serde_json::from_str(&run(&["read", "ours.usda"])).unwrap();
    assert_eq!(read["curves"], 7);
    let (ours, points) = (sum(&folder.join("ours.obj")), read["points"].as_u64().unwrap());
    assert!(same(ours, &read["sum"], points), "{ours:?} {read}");
    assert!(!same([ours[0], ours[1] + 0.01, ours[2]], &read["sum"], points), "tells what differs");
    // A character in motion, at rest and in its twelfth frame.
    tresses(folder, &["export", "--style", "bob", "--strands", "500", "--out", "bob.usda"]);
    for code in ["0", "12"] {
        tresses(folder, &["convert", "bob.usda", "bob.obj", "--as-is", "--frame", code]);
        let (ours, posed) = (sum(&folder.join("bob.obj")), run(&["posed", "bob.usda", code]));
        let posed: Value = serde_json::from_str(&posed).unwrap();
        let hair = &posed["BasisCurves"];
        let points = hair["points"].as_u64().unwrap();
        assert!(same(ours, &hair["sum"], points), "{ours:?} {hair}");
        assert!(!same(ours, &posed["Mesh"]["sum"], points), "tells what differs");
    }
}
