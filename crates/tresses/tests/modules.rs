//! The modules of the crate depend on each other in one direction, without cycles.

use std::path::Path;
use tresses_testing::Modules;

#[test]
fn modules_have_no_circles() {
    let modules = Modules::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs"));
    let report = modules.report();
    assert!(report.is_empty(), "{report}");
}
