//! The module graph of the page builder.

use std::path::Path;

#[test]
fn modules_have_no_circles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs");
    let report = tresses_testing::Modules::read(&root).report();
    assert!(report.is_empty(), "{report}");
}
