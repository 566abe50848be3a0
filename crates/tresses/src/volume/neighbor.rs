//! Another groom in a groom's grid.

use super::{
    Pipelines,
    params::{VolumeUniforms, offset},
};
use crate::{Pose, gpu::Uniform};
use glam::Vec3;

/// Another groom that meets this one in this frame.
#[derive(Debug)]
pub(super) struct Neighbor {
    pub guides: wgpu::Buffer,
    pub uniforms: Uniform,
    pub splat: wgpu::BindGroup,
    pub base: VolumeUniforms,
    pub transform: Pose,
    pub closing: Vec3,
}

impl Neighbor {
    /// Records the splat of its hair in step `i`.
    pub fn record(&self, pipelines: &Pipelines, pass: &mut crate::gpu::ComputePass<'_>, i: u32) {
        pipelines.splat.record(pass, &self.splat, &[offset(i)], self.base.splat_workgroups());
    }
}
