//! A compute kernel: one linked shader, one pipeline, a bind group layout of its own and those that it
//! shares with other kernels.

use super::bindings::{self, Binding};
use crate::shaders;

/// A compute pipeline and the layout of its own bind group, `@group(0)`.
#[derive(Debug)]
pub struct Kernel {
    label: &'static str,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

impl Kernel {
    /// Builds the kernel of the shader `module` (for example `simulate::step`), whose entry point
    /// has the name of the module's last part and whose nth binding is `entries[n]`.
    pub fn new(device: &wgpu::Device, module: &'static str, entries: &[Binding]) -> Self {
        Self::beside(device, module, entries, &[])
    }

    /// [`new`](Self::new) for a shader that also binds groups of the layouts `shared`, `@group(1)` first:
    /// set them on the pass before [`record`](Self::record).
    pub fn beside(
        device: &wgpu::Device,
        module: &'static str,
        entries: &[Binding],
        shared: &[&wgpu::BindGroupLayout],
    ) -> Self {
        let entry_point = module.rsplit("::").next().expect("a module path has a last part");
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(module),
            source: wgpu::ShaderSource::Wgsl(shaders::source(module).into()),
        });
        let layout = bindings::layout(device, module, wgpu::ShaderStages::COMPUTE, entries);
        let layouts: Vec<_> = std::iter::once(Some(&layout)).chain(shared.iter().map(|l| Some(*l))).collect();
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(module),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(module),
                bind_group_layouts: &layouts,
                immediate_size: 0,
            })),
            module: &shader,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                // Every kernel writes its workgroup memory before it reads it.
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        Self { label: module, pipeline, layout }
    }

    /// A bind group for [`record`](Self::record).
    pub fn bind(&self, device: &wgpu::Device, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
        bindings::group(device, self.label, &self.layout, resources)
    }

    /// Records one dispatch of `workgroups` workgroups. More than 65,535 spread over two
    /// dimensions: the kernel takes its workgroup's index as `id.x + id.y * count.x` and checks it.
    pub fn record(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        offsets: &[u32],
        workgroups: u32,
    ) {
        if workgroups == 0 {
            return;
        }
        const WIDTH: u32 = 65_535;
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, offsets);
        pass.dispatch_workgroups(workgroups.min(WIDTH), workgroups.div_ceil(WIDTH), 1);
    }

    /// Records one dispatch of a grid of workgroups.
    pub fn record_grid(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        offsets: &[u32],
        [x, y, z]: [u32; 3],
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, offsets);
        pass.dispatch_workgroups(x, y, z);
    }
}
