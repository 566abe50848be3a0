//! Every shader translates to the languages of other systems: HLSL for Direct3D 12, MSL for Metal. Only naga translates;
//! no driver compiles the result.

use for_tests_naga::{
    Module,
    back::{hlsl, msl, pipeline_constants::process_overrides},
    front::wgsl,
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};
use std::{error::Error, result::Result};

/// Returns the shader in HLSL, shader model 6.0.
fn to_hlsl(module: &Module, info: &ModuleInfo) -> Result<String, Box<dyn Error>> {
    let options = hlsl::Options { shader_model: hlsl::ShaderModel::V6_0, ..Default::default() };
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
    // WebGPU has all functions for packed 16-bit floats.
    let capabilities = Capabilities::default() | Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    let mut old = 0;
    for (name, source) in tresses::shaders::all() {
        let module = wgsl::parse_str(source).unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut validator = Validator::new(ValidationFlags::all(), capabilities);
        let info = validator.validate(&module).unwrap_or_else(|error| panic!("{name}: {error:?}"));
        let (module, info) = process_overrides(&module, &info, None, &Default::default())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let entries: Vec<_> = module.entry_points.iter().map(|entry| &*entry.name).collect();
        let hlsl = to_hlsl(&module, &info).unwrap_or_else(|error| panic!("{name} to HLSL: {error}"));
        // The first version with invariant positions.
        let msl = to_msl(&module, &info, (2, 1)).unwrap_or_else(|error| panic!("{name} to MSL: {error}"));
        for entry in entries {
            assert!(hlsl.contains(entry) && msl.contains(entry), "{name}: {entry} is missing");
        }
        old += usize::from(to_msl(&module, &info, (1, 0)).is_err());
    }
    // Metal 1.0 lacks invariant positions and instance indices, so errors are detected.
    assert!(old > 0);
}
