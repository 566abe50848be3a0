//! No kernel that a GPU runs spills registers.

use std::process::Command;

#[test]
#[ignore = "proof"]
fn no_kernel_spills_on_a_gpu() {
    let done = Command::new(env!("CARGO_BIN_EXE_tresses-evidence")).arg("kernels").output().unwrap();
    println!("{}", String::from_utf8_lossy(&done.stdout));
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}
