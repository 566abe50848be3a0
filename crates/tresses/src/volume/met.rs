//! Another groom in the grid of one.

use super::{
    Pipelines,
    params::{VolumeUniforms, offset},
};
use crate::Pose;
use glam::Vec3;

/// A groom that is met in this frame.
#[derive(Debug)]
pub(super) struct Met {
    pub guides: wgpu::Buffer,
    pub uniforms: wgpu::Buffer,
    pub splat: wgpu::BindGroup,
    pub base: VolumeUniforms,
    pub way: Pose,
    pub closing: Vec3,
}

impl Met {
    /// Records it into the grid in step `i`.
    pub fn record(&self, pipelines: &Pipelines, pass: &mut crate::gpu::ComputePass<'_>, i: u32) {
        pipelines.splat.record(pass, &self.splat, &[offset(i)], self.base.splat_workgroups());
    }
}
