//! Every shader translates to the languages of other systems: HLSL for Direct3D 12, MSL for Metal. Only naga
//! translates; no driver compiles the result. Its SPIR-V for Vulkan is valid.

use for_tests_naga::{
    Module,
    back::{hlsl, msl, pipeline_constants::process_overrides, spv},
    front::wgsl,
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};
use std::{
    error::Error,
    io::Write,
    process::{Command, Stdio},
    result::Result,
};
use tresses::low_level::shaders;

/// Calls `check` with the name of each shader, its module without overrides, and what validation knows of it.
fn each(mut check: impl FnMut(&str, &Module, &ModuleInfo)) {
    // WebGPU has all functions for packed 16-bit floats.
    let capabilities = Capabilities::default() | Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    for (name, source) in shaders::all() {
        let source = &shaders::for_gpu(source);
        let module = wgsl::parse_str(source).unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut validator = Validator::new(ValidationFlags::all(), capabilities);
        let info = validator.validate(&module).unwrap_or_else(|error| panic!("{name}: {error:?}"));
        let (module, info) = process_overrides(&module, &info, None, &Default::default())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        check(name, &module, &info);
    }
}

/// Returns the shader in HLSL of this shader model.
fn to_hlsl(
    module: &Module,
    info: &ModuleInfo,
    shader_model: hlsl::ShaderModel,
) -> Result<String, Box<dyn Error>> {
    let options = hlsl::Options { shader_model, ..Default::default() };
    let pipeline = hlsl::PipelineOptions::default();
    let mut text = String::new();
    let translated = hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None)?;
    translated.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(text)
}

/// Returns the shader in MSL of this version.
fn to_msl(module: &Module, info: &ModuleInfo, version: (u8, u8)) -> Result<String, Box<dyn Error>> {
    let options = msl::Options { lang_version: version, ..Default::default() };
    let (text, translated) = msl::write_string(module, info, &options, &Default::default())?;
    translated.entry_point_names.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(text)
}

#[test]
fn shaders_translate_to_hlsl_and_msl() {
    let mut old = 0;
    each(|name, module, info| {
        // 6.0 for DXC; 5.1 for FXC, which wgpu uses where there is no DXC.
        let [hlsl, fxc] = [hlsl::ShaderModel::V6_0, hlsl::ShaderModel::V5_1].map(|model| {
            to_hlsl(module, info, model).unwrap_or_else(|error| panic!("{name} to HLSL: {error}"))
        });
        // The first version with invariant positions.
        let msl = to_msl(module, info, (2, 1)).unwrap_or_else(|error| panic!("{name} to MSL: {error}"));
        for entry in &module.entry_points {
            assert!(
                [&hlsl, &fxc, &msl].iter().all(|text| text.contains(&entry.name)),
                "{name}: {} is missing",
                entry.name
            );
        }
        old += usize::from(to_msl(module, info, (1, 0)).is_err());
    });
    // Metal 1.0 lacks invariant positions and instance indices, so errors are detected.
    assert!(old > 0);
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
    each(|name, module, info| {
        // A library for a host's shaders, without an entry point.
        if module.entry_points.is_empty() {
            return;
        }
        let words = spv::write_vec(module, info, &spv::Options::default(), None)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        match invalid(&words).flatten() {
            Some(problem) if problem.contains(NAGA_SAMPLE_MASK) => println!("{name}: {problem}"),
            Some(problem) => panic!("{name}: {problem}"),
            None => {}
        }
    });
}
