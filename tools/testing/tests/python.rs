//! The module graph of the Python package. The test is here because tests of the workspace do not compile the package.

use std::path::Path;

#[test]
fn modules_of_the_python_package_have_no_circles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bindings/python/src/lib.rs");
    let report = tresses_testing::Modules::read(&root).report();
    assert!(report.is_empty(), "{report}");
}
