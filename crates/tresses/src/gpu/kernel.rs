//! A compute kernel: one linked shader, one pipeline, its own bind group layout and those it shares with other kernels.

use super::{
    bindings::{self, Bindings},
    handle::Device,
    pipeline,
};
use crate::{Error, Result, shaders};
use std::sync::OnceLock;

/// A compute pipeline and the layout of its own bind group, `@group(0)`. The pipeline is compiled when it is first
/// recorded, or by [`compile`](Self::compile).
#[derive(Debug)]
pub struct Kernel {
    device: Device,
    module: &'static str,
    modules: &'static [&'static str],
    layout: wgpu::BindGroupLayout,
    shared: Vec<wgpu::BindGroupLayout>,
    pipeline: OnceLock<Result<wgpu::ComputePipeline, String>>,
}

/// A compilation that can run in parallel with others.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) type Job<'a> = Box<dyn Fn() -> Result<()> + Send + Sync + 'a>;
/// A compilation. In a browser they run in sequence, since browser objects belong to one thread.
#[cfg(target_arch = "wasm32")]
pub(crate) type Job<'a> = Box<dyn Fn() -> Result<()> + 'a>;

/// Returns jobs that compile `kernels`.
pub(crate) fn jobs<'a>(kernels: impl IntoIterator<Item = &'a Kernel>) -> Vec<Job<'a>> {
    kernels.into_iter().map(|kernel| Box::new(|| kernel.compile()) as Job<'a>).collect()
}

impl Kernel {
    /// Creates the kernel whose bindings are `B`. Its entry point is named after the last part of its module.
    pub(crate) fn new<B: Bindings>(device: &Device) -> Self {
        Self::with_shared::<B>(device, &[])
    }

    /// As [`new`](Self::new), for a shader that also binds groups of the layouts `shared`, `@group(1)` first. The
    /// caller sets them on the pass before [`record`](Self::record).
    pub(crate) fn with_shared<B: Bindings>(device: &Device, shared: &[&wgpu::BindGroupLayout]) -> Self {
        Self::named::<B>(device, B::MODULES[0], shared)
    }

    /// As [`with_shared`](Self::with_shared), for one of several shaders with these bindings, or a variant of one (for
    /// example `simulate::step::16`).
    pub(crate) fn named<B: Bindings>(
        device: &Device,
        module: &'static str,
        shared: &[&wgpu::BindGroupLayout],
    ) -> Self {
        let layout = B::LAYOUT.iter().copied();
        Self {
            device: device.clone(),
            module,
            modules: B::MODULES,
            layout: bindings::numbered_layout(device, module, wgpu::ShaderStages::COMPUTE, layout),
            shared: shared.iter().map(|layout| (*layout).clone()).collect(),
            pipeline: OnceLock::new(),
        }
    }

    /// Creates a kernel for each of several shaders with these bindings, or variants of one.
    pub(crate) fn each<B: Bindings, const N: usize>(
        device: &Device,
        modules: [&'static str; N],
    ) -> [Self; N] {
        modules.map(|module| Self::named::<B>(device, module, &[]))
    }

    /// Compiles the kernel unless it is compiled already.
    ///
    /// # Errors
    /// [`Error::Gpu`] with wgpu's message.
    pub fn compile(&self) -> Result<()> {
        self.pipeline().map(|_| ())
    }

    fn pipeline(&self) -> Result<&wgpu::ComputePipeline> {
        let compiled = self.pipeline.get_or_init(|| {
            // Parts after the entry point name the variant: `simulate::step::workgroup::32`.
            let text = shaders::source(self.module);
            let is_entry = |part: &&str| text.contains(&format!("fn {part}("));
            let entry = self.module.rsplit("::").find(is_entry).unwrap_or(self.module);
            let layouts: Vec<_> = std::iter::once(&self.layout).chain(&self.shared).collect();
            let options = wgpu::PipelineCompilationOptions {
                // Every kernel writes its workgroup memory before it reads it.
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            };
            let source = (text, entry);
            pipeline::compute(&self.device, self.module, source, &layouts, options)
                .map_err(|error| error.to_string())
        });
        compiled.as_ref().map_err(|problem| Error::Gpu { stage: self.module, problem: problem.clone() })
    }

    /// Creates a bind group for [`record`](Self::record).
    pub(crate) fn bind<B: Bindings>(&self, bindings: &B) -> wgpu::BindGroup {
        assert_eq!(self.modules, B::MODULES, "bindings of another kernel");
        let resources = B::LAYOUT.iter().zip(bindings.resources());
        let entries: Vec<_> = resources
            .map(|((binding, _), resource)| wgpu::BindGroupEntry { binding: *binding, resource })
            .collect();
        self.device.numbered_group(self.module, &self.layout, &entries)
    }

    /// Records a dispatch of `workgroups` workgroups. More than 65,535 are spread over two dimensions: the kernel
    /// computes its workgroup's index as `id.x + id.y * count.x` and checks it against the range.
    pub fn record(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        offsets: &[u32],
        workgroups: u32,
    ) {
        if workgroups == 0 {
            return;
        }
        const WIDTH: u32 = 65_535;
        self.record_grid(pass, group, offsets, [workgroups.min(WIDTH), workgroups.div_ceil(WIDTH), 1]);
    }

    /// Records a dispatch of a grid of workgroups. If the kernel fails to compile, nothing is recorded, and the pass
    /// returns the error when it [ends](crate::gpu::ComputePass::end).
    pub(crate) fn record_grid(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        offsets: &[u32],
        [x, y, z]: [u32; 3],
    ) {
        if self.set(pass, group, offsets) {
            pass.dispatch_workgroups(x, y, z);
        }
    }

    /// Records an indirect dispatch. `workgroups` is a buffer with the x, y and z counts, and the byte offset of the
    /// first.
    pub(crate) fn record_indirect(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        offsets: &[u32],
        (workgroups, from): (&wgpu::Buffer, u64),
    ) {
        if self.set(pass, group, offsets) {
            pass.dispatch_workgroups_indirect(workgroups, from);
        }
    }

    /// Sets pipeline and bind group. Returns false if the kernel fails to compile.
    fn set(&self, pass: &mut crate::gpu::ComputePass<'_>, group: &wgpu::BindGroup, offsets: &[u32]) -> bool {
        match self.pipeline() {
            Ok(pipeline) => {
                pass.name(self.module);
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, group, offsets);
                true
            }
            Err(error) => {
                pass.fail(error);
                false
            }
        }
    }
}
