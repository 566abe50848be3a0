//! Time and errors of each shader: as a module, as part of the pipelines that the program compiles, and, for compute
//! shaders, as a pipeline alone.

use super::{
    device, milliseconds,
    section::{Draft, cells},
};
use anyhow::Result;
use pollster::block_on;
use std::{
    borrow::Cow,
    time::{Duration, Instant},
};
use tresses::{Context, Gpu, PipelineRequest, low_level::shaders};
use tresses_scene::{Settings, Value};

/// Compiles all shaders on the default adapter.
pub fn measure(draft: &mut Draft, quick: bool) -> Result<()> {
    let gpu = device::open()?;
    let Gpu { context, .. } = &gpu;
    draft.note("Drivers store compiled shaders on disk, so a second run is faster.");
    // First the pipelines as the program compiles them, before the driver has stored any.
    for (name, request) in requests(context)? {
        let start = Instant::now();
        let result = block_on(context.prepare(&[request], &()));
        let problem = result.err().map(|error| error.to_string());
        if let Some(problem) = &problem {
            draft.find(format!("pipelines of {name}: {problem}"));
        }
        let row = cells![name, milliseconds(start), problem];
        draft.row("Pipelines by request", &["request", "ms", "error"], row);
        draft.keep();
    }
    let seconds = if context.tier().software { 10 } else { 120 };
    let limit = Duration::from_secs(if quick { seconds / 4 } else { seconds });
    let (start, mut skipped) = (Instant::now(), 0);
    for (name, wgsl) in shaders::all() {
        let wgsl = if context.tier().software { Cow::Borrowed(*wgsl) } else { shaders::for_gpu(wgsl) };
        skipped += u32::from(start.elapsed() > limit);
        shader(draft, context.device(), (name, &wgsl), start.elapsed() <= limit);
        draft.keep();
    }
    if skipped > 0 {
        draft.note(format!("{skipped} shaders were not compiled as pipelines alone: the time was over."));
    }
    Ok(())
}

/// Adds the row of a shader.
fn shader(draft: &mut Draft, device: &wgpu::Device, (name, wgsl): (&str, &str), compiles: bool) {
    let (module, module_ms, problem) = scoped(device, || {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        })
    });
    let mut problems: Vec<String> = problem.into_iter().collect();
    let mut pipeline_ms = None;
    if problems.is_empty() && compiles {
        for entry in entries(wgsl) {
            let (_, ms, problem) = scoped(device, || {
                device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(name),
                    layout: None,
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    cache: None,
                })
            });
            problems.extend(problem);
            pipeline_ms = Some(pipeline_ms.unwrap_or(0.0) + ms);
        }
    }
    for problem in &problems {
        draft.find(format!("shader {name}: {problem}"));
    }
    let error = (!problems.is_empty()).then(|| problems.join("\n"));
    let row = cells![name, module_ms, pipeline_ms, error];
    draft.row("Shaders", &["shader", "module, ms", "pipeline, ms", "error"], row);
}

/// Returns the result of `work`, its time in milliseconds, and the error that wgpu reported.
fn scoped<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> (T, f64, Option<String>) {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let start = Instant::now();
    let result = work();
    let ms = milliseconds(start);
    let internal = block_on(internal.pop());
    let error = block_on(validation.pop()).or(internal);
    (result, ms, error.map(|error| error.to_string()))
}

/// Returns the pipelines that the program requests, with their names.
fn requests(context: &Context) -> Result<Vec<(String, PipelineRequest)>> {
    let max_samples = context.tier().max_samples;
    let mut requests = vec![
        ("skinned meshes".to_owned(), PipelineRequest::Skinning),
        ("roots".to_owned(), PipelineRequest::Roots),
        ("strands".to_owned(), PipelineRequest::Strands),
        ("strand collision".to_owned(), PipelineRequest::Avoid),
        ("forces".to_owned(), PipelineRequest::Forces),
        ("self-collision".to_owned(), PipelineRequest::Volume),
        ("wind".to_owned(), PipelineRequest::Wind),
        ("cards".to_owned(), PipelineRequest::Cards(4.min(max_samples))),
    ];
    // A software driver compiles a step for seconds.
    let sizes: &[u32] = if context.tier().software { &[16] } else { &[16, 32] };
    for &vertices in sizes {
        requests.push((format!("step, {vertices} vertices"), PipelineRequest::Step(vertices)));
        requests
            .push((format!("step with twist, {vertices} vertices"), PipelineRequest::TwistStep(vertices)));
    }
    for renderer in ["tiles", "masks", "classic"] {
        let mut settings = Settings::default();
        settings.set("renderer.kind", Value::Choice(renderer))?;
        let view = PipelineRequest::View(settings.view_options(max_samples)?);
        requests.push((format!("view, {renderer}"), view));
    }
    Ok(requests)
}

/// Returns the names of the compute entry points of `wgsl`.
fn entries(wgsl: &str) -> impl Iterator<Item = &str> {
    wgsl.split("@compute").skip(1).filter_map(|text| {
        let (_, name) = text.split_once("fn ")?;
        Some(name.split('(').next()?.trim())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entry_points_are_found() {
        let wgsl =
            "fn a() {} @compute @workgroup_size(64)\nfn b(@builtin(x) c: vec3u) {} @fragment fn d() {}";
        assert_eq!(entries(wgsl).collect::<Vec<_>>(), ["b"]);
        assert!(shaders::all().iter().filter(|(_, wgsl)| entries(wgsl).count() > 0).count() > 50);
    }
}
