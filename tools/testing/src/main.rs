//! Prints the module cycles of crates, given their root files: `cargo run -p tresses-testing -- crates/*/src/lib.rs`.

use std::path::PathBuf;

fn main() {
    for root in std::env::args_os().skip(1).map(PathBuf::from) {
        println!("{}\n{}", root.display(), tresses_testing::Modules::read(&root).report());
    }
}
