//! What compilers of GPUs make of the shaders: no kernel spills registers, and every module is valid SPIR-V.

use std::{
    io::Write,
    process::{Command, Stdio},
};
use wgpu::naga::{
    back::{pipeline_constants::process_overrides, spv},
    front::wgsl,
    valid::{Capabilities, ValidationFlags, Validator},
};

#[test]
#[ignore = "proof"]
fn no_kernel_spills_on_a_gpu() {
    let done = Command::new(env!("CARGO_BIN_EXE_tresses-evidence")).arg("kernels").output().unwrap();
    println!("{}", String::from_utf8_lossy(&done.stdout));
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// Returns what `spirv-val` has against the words of a module, or `None` if there is no such program.
fn invalid(words: &[u32]) -> Option<Option<String>> {
    let mut check = Command::new("spirv-val")
        .args(["--target-env", "vulkan1.1", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .ok()?;
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    // A program that has found an error may not read on.
    let _ = check.stdin.take().expect("it is piped").write_all(&bytes);
    let done = check.wait_with_output().expect("it ends");
    Some((!done.status.success()).then(|| String::from_utf8_lossy(&done.stderr).into_owned()))
}

/// naga 30 writes sample masks as a number, where Vulkan asks for an array of one.
const NAGA_SAMPLE_MASK: &str = "VUID-SampleMask-SampleMask-04359";

#[test]
#[ignore = "proof"]
fn every_module_is_valid_spirv() {
    if invalid(&[0]).is_none() {
        return println!("not run: spirv-val (package spirv-tools) is not installed");
    }
    assert!(invalid(&[0]).flatten().is_some(), "errors are detected");
    for (name, source) in tresses::shaders::all() {
        let module = wgsl::parse_str(source).unwrap_or_else(|error| panic!("{name}: {error}"));
        // A library for a host's shaders, without an entry point.
        if module.entry_points.is_empty() {
            continue;
        }
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
        let info = validator.validate(&module).unwrap_or_else(|error| panic!("{name}: {error:?}"));
        let (module, info) = process_overrides(&module, &info, None, &Default::default())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let words = spv::write_vec(&module, &info, &spv::Options::default(), None)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        match invalid(&words).flatten() {
            Some(problem) if problem.contains(NAGA_SAMPLE_MASK) => println!("{name}: {problem}"),
            Some(problem) => panic!("{name}: {problem}"),
            None => {}
        }
    }
}
