//! Tests of the dependency order of the crate's modules.

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
fn modules_depend_only_on_earlier_ones() {
    let list: Vec<_> = include_str!("../src/lib.rs")
        .lines()
        .filter_map(|line| line.strip_prefix("//! - `")?.split_once('`'))
        .map(|(name, _)| name)
        .collect();
    let place = |name: &str| {
        list.iter().position(|listed| *listed == name).unwrap_or_else(|| panic!("{name} is not in the list"))
    };
    for arrow in modules().arrows(&[]) {
        assert!(place(&arrow.to) < place(&arrow.from), "{arrow:?}");
    }
}
