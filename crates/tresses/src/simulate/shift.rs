//! Moves guide state to another origin, before a step in which the carrier's origin has moved ([`crate::space`]).

use super::Pipelines;
use crate::{
    Context,
    constants::VOLUME_WORKGROUP,
    gpu::{BindBuffer, Kernel, Uniform},
    shaders::kernels::simulate as kernels,
    space::Shift,
    strands::GuideBuffers,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::sync::Arc;

/// Offsets for the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct ShiftUniform {
    /// Added to positions, meters.
    pub offset: Vec3,
    /// Number of guide vertices.
    pub count: u32,
    /// Added to velocities, m/s.
    pub velocity: Vec3,
    /// 1 if `velocity` is not zero. Otherwise velocities stay untouched, because packing rounds them.
    pub faster: u32,
}

/// Creates the kernel, when hair first moves far from its origin.
pub(super) fn kernel(context: &Context) -> Kernel {
    Kernel::new::<kernels::Shift>(&context.device)
}

/// Buffers of one groom, created when it first moves far from its origin.
#[derive(Debug)]
pub(crate) struct Shifting {
    pipelines: Arc<Pipelines>,
    uniform: Uniform,
    group: wgpu::BindGroup,
    count: u32,
}

impl Shifting {
    pub fn new(context: &Context, guides: &GuideBuffers) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let uniform = device.storage_uniform(size_of::<ShiftUniform>());
        let group = pipelines.shift.bind(&kernels::Shift {
            u: uniform.entire(),
            current: guides.current.entire(),
            velocity: guides.velocity.entire(),
        });
        Self { pipelines, uniform, group, count: guides.count * guides.vertex_count }
    }

    /// Writes the uniform for `shift`.
    pub fn prepare(&self, shift: &Shift) {
        let uniform = ShiftUniform {
            offset: shift.offset,
            count: self.count,
            velocity: shift.velocity,
            faster: u32::from(shift.velocity != Vec3::ZERO),
        };
        self.uniform.write(0, bytemuck::bytes_of(&uniform));
    }

    /// Records the dispatch.
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        self.pipelines.shift.record(pass, &self.group, &[], self.count.div_ceil(VOLUME_WORKGROUP));
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.uniform.size()
    }
}
