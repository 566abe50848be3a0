//! The kernel that shades strand vertices.

use crate::{
    constants::STRAND_WORKGROUP,
    draw::HairSet,
    gpu::{Binding, Kernel, Timings},
    strands::StrandBuffers,
};

/// The kernel `light::shade`.
#[derive(Debug)]
pub struct Shade(Kernel);

impl Shade {
    /// Builds the kernel.
    pub fn new(device: &wgpu::Device) -> Self {
        use Binding::*;
        Self(Kernel::new(
            device,
            "light::shade",
            &[
                Uniform, Uniform, DepthArray, Comparison, Storage, Storage, Uniform, Storage, Storage,
                StorageMut,
            ],
        ))
    }

    /// `frame` is the first six resources: view, lights and what the shadow maps offer.
    pub(crate) fn bind(
        &self,
        device: &wgpu::Device,
        frame: [wgpu::BindingResource<'_>; 6],
        strands: &StrandBuffers,
        uniform: &wgpu::Buffer,
        shaded: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let hair = [uniform, &strands.vertices, &strands.strands, shaded];
        let resources: Vec<_> =
            frame.into_iter().chain(hair.map(|buffer| buffer.as_entire_binding())).collect();
        self.0.bind(device, &resources)
    }

    /// Records the kernel for all vertices of `hair`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timings: Option<&mut Timings>, hair: &HairSet) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("shade"),
            timestamp_writes: timings.and_then(|timings| timings.compute("shade")),
        });
        let workgroups = (hair.count * hair.vertex_count).div_ceil(STRAND_WORKGROUP);
        self.0.record(&mut pass, &hair.shade_group, &[], workgroups);
    }
}
