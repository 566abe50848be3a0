//! The kernel that gathers what the grids do to the guides.

use crate::{
    constants::VOLUME_WORKGROUP,
    gpu::{Binding, Kernel, bindings},
    strands::GuideBuffers,
    volume::Volume,
};

/// The pipeline.
#[derive(Debug)]
pub(crate) struct ForcesKernel {
    kernel: Kernel,
    sampler: wgpu::Sampler,
}

impl ForcesKernel {
    pub fn new(device: &wgpu::Device) -> Self {
        let entries = [
            Binding::UniformDynamic,
            Binding::Storage,
            Binding::StorageMut,
            Binding::Texture3d,
            Binding::Texture3d,
            Binding::Sampler,
        ];
        Self { kernel: Kernel::new(device, "simulate::forces", &entries), sampler: bindings::linear(device) }
    }
}

/// Writes [`GuideBuffers::forces`] of one groom from its grids.
#[derive(Debug)]
pub struct Forces {
    group: wgpu::BindGroup,
    threads: u32,
}

impl Forces {
    /// The forces of `volume` on `guides`.
    pub fn new(
        device: &wgpu::Device,
        simulate: &super::Simulate,
        guides: &GuideBuffers,
        volume: &Volume,
    ) -> Self {
        let group = simulate.forces.kernel.bind(
            device,
            &[
                volume.uniforms(),
                guides.current.as_entire_binding(),
                guides.forces.as_entire_binding(),
                wgpu::BindingResource::TextureView(&volume.hair),
                wgpu::BindingResource::TextureView(&volume.push),
                wgpu::BindingResource::Sampler(&simulate.forces.sampler),
            ],
        );
        Self { group, threads: guides.count * guides.vertex_count }
    }

    /// Records the dispatch for step `i` of those that [`Volume::prepare`] wrote.
    pub fn record(&self, simulate: &super::Simulate, pass: &mut wgpu::ComputePass<'_>, i: u32) {
        let workgroups = self.threads.div_ceil(VOLUME_WORKGROUP);
        simulate.forces.kernel.record(pass, &self.group, &[Volume::offset(i)], workgroups);
    }
}
