//! Creates all pipelines of the library, at first use and once per key. Error scopes turn a driver's rejection into an
//! [`Error`].
//!
//! No [`wgpu::PipelineCache`] is used: wgpu 30 creates one only by an `unsafe` call, since it trusts the cached bytes,
//! and this library forbids unsafe code. Drivers cache compiled shaders themselves.

use super::{handle::Device, probe};
use crate::{Error, Result, shaders};
use std::{
    collections::HashMap,
    hash::Hash,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// Format of all depth targets. Depth is reversed (1 is near), except in shadow maps.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Module path of a shader, and the name of an entry point in it.
pub(crate) type Entry<'a> = (&'static str, &'a str);

/// Description of a render pipeline.
#[derive(Clone, Copy)]
pub(crate) struct Recipe<'a> {
    pub vertex: Entry<'a>,
    /// `None` for depth-only pipelines.
    pub fragment: Option<Entry<'a>>,
    pub layouts: &'a [&'a wgpu::BindGroupLayout],
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    pub topology: wgpu::PrimitiveTopology,
    /// Whether depth is written, and the depth test. `None` without a depth target.
    pub depth: Option<(bool, wgpu::CompareFunction)>,
    pub samples: u32,
    pub alpha_to_coverage: bool,
    /// Values of the fragment shader's `override` constants, by number.
    pub constants: &'a [(&'a str, f64)],
}

impl Recipe<'_> {
    /// Triangles without vertex buffers, depth or multisampling.
    pub const PLAIN: Self = Self {
        vertex: ("", ""),
        fragment: None,
        layouts: &[],
        buffers: &[],
        targets: &[],
        topology: wgpu::PrimitiveTopology::TriangleList,
        depth: None,
        samples: 1,
        alpha_to_coverage: false,
        constants: &[],
    };

    /// Creates the pipeline.
    ///
    /// # Errors
    /// [`Error::Gpu`] with wgpu's message.
    pub fn build(&self, device: &Device) -> Result<wgpu::RenderPipeline> {
        let label = self.fragment.map_or(self.vertex.0, |fragment| fragment.0);
        scoped(device, label, || {
            let shader = module(device, self.vertex.0);
            let other = self.fragment.filter(|(name, _)| *name != self.vertex.0);
            let other = other.map(|(name, _)| module(device, name));
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&pipeline_layout(device, label, self.layouts)),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(self.vertex.1),
                    compilation_options: Default::default(),
                    buffers: self.buffers,
                },
                // No culling: meshes are often open or wound inconsistently, and strips face the camera.
                primitive: wgpu::PrimitiveState { topology: self.topology, ..Default::default() },
                depth_stencil: self.depth.map(|(write, compare)| wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(write),
                    depth_compare: Some(compare),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState {
                    count: self.samples,
                    alpha_to_coverage_enabled: self.alpha_to_coverage,
                    ..Default::default()
                },
                fragment: self.fragment.map(|(_, entry)| wgpu::FragmentState {
                    module: other.as_ref().unwrap_or(&shader),
                    entry_point: Some(entry),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: self.constants,
                        ..Default::default()
                    },
                    targets: self.targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        })
    }
}

/// Creates a compute pipeline for the entry point `entry` of the WGSL `source`.
///
/// # Errors
/// As [`Recipe::build`].
pub(crate) fn compute(
    device: &Device,
    label: &'static str,
    (source, entry): (&str, &str),
    layouts: &[&wgpu::BindGroupLayout],
    options: wgpu::PipelineCompilationOptions<'_>,
) -> Result<wgpu::ComputePipeline> {
    scoped(device, label, || {
        let shader = shader_module(device, label, source);
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout(device, label, layouts)),
            module: &shader,
            entry_point: Some(entry),
            compilation_options: options,
            cache: None,
        })
    })
}

fn module(device: &Device, name: &'static str) -> wgpu::ShaderModule {
    shader_module(device, name, shaders::source(name))
}

fn shader_module(device: &Device, name: &str, wgsl: &str) -> wgpu::ShaderModule {
    let wgsl = if device.broken == Some(name) { "broken" } else { wgsl };
    let wgsl = if device.is_gpu { shaders::for_gpu(wgsl) } else { wgsl.into() };
    let wgsl = device.rewrite.map_or(wgsl.clone(), |rewrite| rewrite(&wgsl).into());
    if let Some(probe) = &device.probe {
        return probe.shader(device, name, &wgsl);
    }
    let source = wgpu::ShaderSource::Wgsl(wgsl.into_owned().into());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
}

fn pipeline_layout(device: &Device, label: &str, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let mut groups: Vec<_> = groups.iter().map(|group| Some(*group)).collect();
    let own = device.probe.as_ref().map(|probe| probe.layout(device));
    if own.is_some() {
        groups.resize(probe::GROUP as usize, None);
        groups.push(own.as_ref());
    }
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

/// Error scopes of all kinds. They belong to the thread that opens them.
pub(crate) struct Scopes([wgpu::ErrorScopeGuard; 3]);

impl Scopes {
    pub fn open(device: &wgpu::Device) -> Self {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        Self([OutOfMemory, Internal, Validation].map(|filter| device.push_error_scope(filter)))
    }

    /// Closes the scopes. The future returns the first error in them.
    pub fn close(self, stage: &'static str) -> impl Future<Output = Result<()>> {
        let Self([memory, internal, validation]) = self;
        // Scopes close in reverse order. All are popped before the first await.
        let (validation, internal, memory) = (validation.pop(), internal.pop(), memory.pop());
        async move {
            let found = [validation.await, internal.await, memory.await];
            match found.into_iter().flatten().next() {
                Some(error) => Err(Error::Gpu { stage, problem: error.to_string() }),
                None => Ok(()),
            }
        }
    }
}

/// Runs `make` in error scopes. In a browser errors arrive later, so there this returns no error;
/// [`Context::prepare`](crate::Context::prepare) reports them.
pub(crate) fn scoped<T>(device: &wgpu::Device, stage: &'static str, make: impl FnOnce() -> T) -> Result<T> {
    #[cfg(not(target_arch = "wasm32"))]
    {
        let scopes = Scopes::open(device);
        let value = make();
        pollster::block_on(scopes.close(stage))?;
        Ok(value)
    }
    #[cfg(target_arch = "wasm32")]
    {
        let _ = (device, stage);
        Ok(make())
    }
}

/// A cache of values, created at first use, one per key. Threads that need different keys do not wait for each other.
#[derive(Debug)]
pub(crate) struct PipelineCache<K, V>(Mutex<HashMap<K, Slot<V>>>);

type Slot<V> = Arc<Mutex<Option<V>>>;

impl<K, V> Default for PipelineCache<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Eq + Hash, V: Clone> PipelineCache<K, V> {
    /// Returns the value of `key`, created by `make` if it does not exist.
    ///
    /// # Errors
    /// The error of `make`, which the next call runs again.
    pub fn get(&self, key: K, make: impl FnOnce() -> Result<V>) -> Result<V> {
        let slot = lock(&self.0).entry(key).or_default().clone();
        let mut slot = lock(&slot);
        Ok(match &*slot {
            Some(value) => value.clone(),
            None => slot.insert(make()?).clone(),
        })
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic cannot leave a half-written value.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A color target blended with the same factors for color and alpha.
pub(crate) fn blended(
    format: wgpu::TextureFormat,
    src_factor: wgpu::BlendFactor,
    dst_factor: wgpu::BlendFactor,
) -> Option<wgpu::ColorTargetState> {
    let component = wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    Some(wgpu::ColorTargetState {
        format,
        blend: Some(wgpu::BlendState { color: component, alpha: component }),
        write_mask: wgpu::ColorWrites::ALL,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pipelines_that_wgpu_rejects_are_errors_and_can_be_retried() {
        let device = &crate::gpu::noop().device;
        let made = PipelineCache::<u8, wgpu::ComputePipeline>::default();
        let entries = [crate::gpu::Binding::Uniform];
        let layout = crate::gpu::bindings::layout(device, "test", wgpu::ShaderStages::COMPUTE, &entries);
        let wgsl = "@group(0) @binding(0) var<uniform> x: u32;
            @compute @workgroup_size(1) fn run() { _ = x; }";
        let build = |entry, layouts: &[&wgpu::BindGroupLayout]| {
            compute(device, "test", (wgsl, entry), layouts, Default::default())
        };
        let error = made.get(1, || build("missing", &[&layout])).unwrap_err().to_string();
        assert!(error.contains("test"), "{error}");
        assert!(made.get(1, || build("run", &[])).is_err());
        let first = made.get(1, || build("run", &[&layout])).unwrap();
        assert_eq!(made.get(1, || unreachable!()).unwrap(), first);
    }
}
