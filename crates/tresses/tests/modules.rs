//! The modules of the crate depend on each other in one direction, without cycles.

use std::path::Path;
use tresses_testing::Modules;

/// Folders whose modules form a cycle: they share one canvas, or one state of the light.
const CIRCULAR: [&str; 2] = ["draw", "light"];

#[test]
fn modules_have_no_circles() {
    let modules = Modules::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs"));
    let report =
        modules.report_of(|folder| folder.first().is_none_or(|name| !CIRCULAR.contains(&name.as_str())));
    assert!(report.is_empty(), "{report}");
}
