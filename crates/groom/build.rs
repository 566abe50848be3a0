//! Exports the source folder to the build scripts of dependents (`DEP_TRESSES_GROOM_SRC`): `tresses` generates WGSL
//! from some of the structs.

use std::{env, path::PathBuf};

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR"));
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::metadata=src={}", root.join("src").display());
}
