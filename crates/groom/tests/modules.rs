//! The crate's module graph.

use std::path::Path;
use tresses_testing::Modules;

fn modules() -> Modules {
    Modules::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs"))
}

#[test]
fn modules_have_no_circles() {
    let report = modules().report();
    assert!(report.is_empty(), "{report}");
}

#[test]
fn modules_follow_documented_order() {
    let text = include_str!("../src/lib.rs");
    let lines = text.lines().filter_map(|line| line.strip_prefix("//! ")?.split_once(" │ "));
    let order: Vec<Vec<&str>> = lines.map(|(names, _)| names.split_whitespace().collect()).collect();
    let place = |name: &str| order.iter().position(|line| line.contains(&name));
    let declared = text.lines().filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod "));
    for name in declared.map(|name| name.trim_end_matches(';')) {
        assert!(place(name).is_some(), "lib.rs does not list {name}");
    }
    for arrow in modules().arrows(&[]) {
        assert!(place(&arrow.to) < place(&arrow.from), "{arrow:?}");
    }
}
