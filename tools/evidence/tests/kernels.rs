//! No kernel that a GPU runs spills more registers than is known, for the chips whose drivers are there.

use std::process::Command;

#[test]
#[ignore = "proof"]
fn no_kernel_spills_on_a_gpu() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tresses-evidence"));
    // Where `scripts/gpu-compilers` unpacks drivers.
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let done = command.arg("kernels").output().unwrap();
    println!("{}", String::from_utf8_lossy(&done.stdout));
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}
