//! The library is small enough to be learned: few public types, most of them in `low_level`, each with one path.

use std::path::Path;
use tresses_testing::PublicTypes;

/// The most public types: of the crate, and of the layer for hosts.
const LIMITS: [usize; 2] = [128, 67];

#[test]
fn public_types_are_few_and_have_one_path() {
    let types = PublicTypes::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs"));
    let all: Vec<_> = types.paths().collect();
    let list = all.iter().flat_map(|paths| paths.iter()).map(|path| format!("{path}\n")).collect::<String>();
    let twice: Vec<_> = all.iter().filter(|paths| paths.len() > 1).collect();
    assert!(twice.is_empty(), "types with several public paths: {twice:?}");
    let hosts = all.iter().filter(|paths| paths.iter().all(|path| !path.starts_with("low_level::"))).count();
    let counts = [all.len(), hosts];
    println!("{} public types, {} of them for hosts", counts[0], counts[1]);
    assert!(counts[0] <= LIMITS[0] && counts[1] <= LIMITS[1], "{counts:?} exceed {LIMITS:?}:\n{list}");
    assert!(counts[0] > LIMITS[0] / 2 && list.contains("low_level::Hair\n"), "types are missing:\n{list}");
}
