//! Prints the circles of the crates whose root files are named: `cargo run -p tresses-modules -- crates/*/src/lib.rs`.

use std::path::PathBuf;

fn main() {
    for root in std::env::args_os().skip(1).map(PathBuf::from) {
        println!("{}\n{}", root.display(), tresses_modules::Modules::read(&root).report());
    }
}
