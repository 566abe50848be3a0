//! The kernel that shades strand vertices.

use crate::{
    constants::STRAND_WORKGROUP,
    draw::HairSet,
    gpu::{
        Binding, Kernel, Timings,
        bindings::{group, layout},
    },
    strands::StrandBuffers,
};

/// What it and its sibling `light::terms` bind.
pub(super) const BINDINGS: [Binding; 12] = [
    Binding::Uniform,
    Binding::Uniform,
    Binding::DepthArray,
    Binding::Comparison,
    Binding::Storage,
    Binding::Storage,
    Binding::Texture3d,
    Binding::Sampler,
    Binding::Uniform,
    Binding::Storage,
    Binding::Storage,
    Binding::StorageMut,
];

/// The kernel `light::shade`.
#[derive(Debug)]
pub struct Shade {
    kernel: Kernel,
    /// Nothing: the fibres' tables are `@group(2)`, as in the pipelines that draw.
    gap: wgpu::BindGroup,
}

impl Shade {
    /// Builds the kernel. `fiber` is the layout of the fibres' tables.
    pub fn new(device: &wgpu::Device, fiber: &wgpu::BindGroupLayout) -> Self {
        let nothing = layout(device, "nothing", wgpu::ShaderStages::COMPUTE, &[]);
        Self {
            gap: group(device, "nothing", &nothing, &[]),
            kernel: Kernel::beside(device, "light::shade", &BINDINGS, &[&nothing, fiber]),
        }
    }

    /// `frame` is the first eight resources: view, lights, what the shadow maps offer and light from all sides.
    pub(crate) fn bind(
        &self,
        device: &wgpu::Device,
        frame: [wgpu::BindingResource<'_>; 8],
        strands: &StrandBuffers,
        uniform: &wgpu::Buffer,
        shaded: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let hair = [uniform, &strands.vertices, &strands.strands, shaded];
        let resources: Vec<_> =
            frame.into_iter().chain(hair.map(|buffer| buffer.as_entire_binding())).collect();
        self.kernel.bind(device, &resources)
    }

    /// Records the kernel for all vertices of `hair`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timings: Option<&mut Timings>, hair: &HairSet) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("shade"),
            timestamp_writes: timings.and_then(|timings| timings.compute("shade")),
        });
        let workgroups = (hair.drawn.count * hair.drawn.vertex_count).div_ceil(STRAND_WORKGROUP);
        pass.set_bind_group(1, &self.gap, &[]);
        pass.set_bind_group(2, &hair.fiber.group, &[]);
        self.kernel.record(&mut pass, &hair.shade_group, &[], workgroups);
    }
}
