//! `tresses info` and `tresses convert` as processes.

use crate::{output as tresses, stderr};

const OBJ: &str = "v 0 1.7 0
v 0 1.75 -0.1
v 0 1.7 -0.2
v 0.05 1.69 0
v 0.05 1.69 0
v 0.1 1.6 -0.1
l 1 2 3
l 4 5 6
";

/// Unit and axes of that groom, which the file does not state.
const GIVEN: [&str; 6] = ["--unit", "m", "--up", "y", "--front", "z"];

/// Returns a folder with the groom `in.obj`.
fn groom() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.obj"), OBJ).unwrap();
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn groom_round_trips_through_the_formats() {
    let folder = groom();
    let here = folder.path();
    let steps: &[&[&str]] = &[
        &["convert", "in.obj", "a.hair"],
        &["convert", "a.hair", "b.tfx"],
        &["convert", "b.tfx", "c.obj"],
        &["convert", "c.obj", "d.obj"],
    ];
    for (i, step) in steps.iter().enumerate() {
        let args: Vec<&str> = step.iter().chain(if i == 0 { &GIVEN[..] } else { &[] }).copied().collect();
        let out = tresses(here, &args);
        assert!(out.status.success(), "{}", stderr(&out));
    }
    assert_eq!(std::fs::read(here.join("c.obj")).unwrap(), std::fs::read(here.join("d.obj")).unwrap());
    let last = std::fs::read_to_string(here.join("d.obj")).unwrap();
    assert_eq!(last.lines().filter(|l| l.starts_with('v')).count(), 5, "the duplicate is merged: {last}");
    assert!(last.contains("v 0.05 1.69 0\n"), "{last}");
    // No other files remain.
    assert_eq!(std::fs::read_dir(here).unwrap().count(), 5);
}

#[test]
fn width_is_written_and_checked() {
    let folder = groom();
    let here = folder.path();
    let convert = |more: &[&str]| tresses(here, &[&["convert", "in.obj"][..], more, &GIVEN].concat());
    let out = convert(&["out.abc", "--width", "80um", "--out-unit", "cm"]);
    assert!(out.status.success(), "{}", stderr(&out));
    let json = tresses(here, &["info", "out.abc", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!((json["radius_m"]["median"].as_f64().unwrap() - 40e-6).abs() < 1e-9, "{json}");
    for (more, problem) in [
        (&["out.abc", "--width", "8"][..], "from 10 to 5000 µm"),
        (&["out.abc", "--width", "thick"], "from 10 to 5000 µm"),
        (&["out.tresses", "--width", "80um"], "remove --width"),
        (&["out.obj", "--width", "80um"], ""),
    ] {
        let out = convert(more);
        let told = stderr(&out) + &text(&out.stdout);
        assert_eq!(out.status.success(), problem.is_empty(), "{told}");
        assert!(told.contains(if problem.is_empty() { "widths are not written" } else { problem }), "{told}");
    }
}

#[test]
fn info_lists_findings_and_actions() {
    let folder = groom();
    let out = tresses(folder.path(), &["info", "in.obj"]);
    assert!(out.status.success(), "{}", stderr(&out));
    let report = text(&out.stdout);
    assert!(report.contains("duplicate vertices: 1") && report.contains("→"), "{report}");
    assert!(report.contains("none marked in the file: 1 of the strands"), "{report}");
    let out = tresses(folder.path(), &["info", "in.obj", "--json", "--unit", "cm"]);
    let json: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((json["strands"].as_u64(), json["vertices"].as_u64()), (Some(2), Some(6)));
    assert_eq!(json["groom_placement"]["meters_per_unit"].as_f64().unwrap() as f32, 0.01);
    assert_eq!(json["findings"][0]["count"].as_u64(), Some(1));
}

#[test]
fn invalid_input_is_an_error_of_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("cut.hair"), &b"HAIR\x01\0\0\0\x02\0\0\0\x02\0\0\0"[..]).unwrap();
    std::fs::write(here.join("nan.obj"), OBJ.replace("1.75", "nan")).unwrap();
    std::fs::write(here.join("flat.obj"), "v 0 0 0\nv 0 0 0\nl 1 2\n").unwrap();
    std::fs::write(here.join("good.obj"), OBJ).unwrap();
    let files = std::fs::read_dir(here).unwrap().count();
    for (args, says) in [
        (&["convert", "cut.hair", "out.obj"][..], "cut.hair at byte 16:"),
        (&["convert", "nan.obj", "out.hair"], "nan.obj at line 2:"),
        (&["convert", "flat.obj", "out.hair"], "flat.obj: "),
        (&["convert", "absent.obj", "out.hair"], "absent.obj: "),
        (&["convert", "good.obj", "out.xyz"], "out.xyz: "),
        (&["convert", "good.obj", "no/such/folder/out.obj"], "out.obj: "),
        (&["info", "nan.obj"], "nan.obj at line 2:"),
        (&["info", "cut.hair"], "cut.hair at byte 16:"),
        (&["info", "good.obj", "--head", "good.obj"], "good.obj: "),
    ] {
        let out = tresses(here, args);
        let error = stderr(&out);
        assert_eq!(out.status.code(), Some(1), "{args:?}: {error}");
        assert!(error.contains(says) && error.trim_end().lines().count() == 1, "{args:?}: {error}");
    }
    assert_eq!(std::fs::read_dir(here).unwrap().count(), files, "nothing is written");
}
