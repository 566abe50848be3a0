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
            &[Uniform, Uniform, Uniform, DepthArray, Storage, Storage, StorageMut],
        ))
    }

    pub(crate) fn bind(
        &self,
        device: &wgpu::Device,
        frame: [&wgpu::Buffer; 2],
        maps: &wgpu::TextureView,
        strands: &StrandBuffers,
        uniform: &wgpu::Buffer,
        shaded: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        self.0.bind(
            device,
            &[
                frame[0].as_entire_binding(),
                frame[1].as_entire_binding(),
                uniform.as_entire_binding(),
                wgpu::BindingResource::TextureView(maps),
                strands.vertices.as_entire_binding(),
                strands.strands.as_entire_binding(),
                shaded.as_entire_binding(),
            ],
        )
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
