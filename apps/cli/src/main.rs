//! The `tresses` command.
fn main() {}
