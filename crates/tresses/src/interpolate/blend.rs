//! Host side of `blend.wesl`.

use crate::{
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Kernel},
    strands::{GuideBuffers, StrandBuffers},
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// The uniform of the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct InterpolateParams {
    /// Rotation of the distance field's frame now.
    pub field_rotation: Quat,
    /// Translation of the distance field's frame now, metres.
    pub field_translation: Vec3,
    /// How far drawn strands keep from the obstacle, metres; 0 switches the test off.
    pub clearance: f32,
    /// Texture coordinate of the origin of the field's frame.
    pub field_bias: Vec3,
    /// Number of strands.
    pub strand_count: u32,
    /// Texture coordinates per metre.
    pub field_scale: Vec3,
    /// Vertices per strand, at least 2.
    pub vertex_count: u32,
    /// Samples per guide, at least 2.
    pub sample_count: u32,
    /// Unused.
    pub _pad_a: u32,
    /// Unused.
    pub _pad_b: u32,
    /// Unused.
    pub _pad_c: u32,
}

/// The pipeline of the stage.
#[derive(Debug)]
pub struct Interpolate {
    kernel: Kernel,
}

impl Interpolate {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        let entries = [
            Binding::Uniform,
            Binding::Storage,
            Binding::Storage,
            Binding::Storage,
            Binding::Storage,
            Binding::StorageMut,
            Binding::Texture3d,
            Binding::Sampler,
        ];
        Self { kernel: Kernel::new(device, "interpolate::blend", &entries) }
    }

    /// Binds the stage to one groom, a uniform buffer of [`InterpolateParams`] and the head's field:
    /// a 3-D texture with the gradient in xyz and the distance in metres in w, and a sampler that
    /// filters.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        params: &wgpu::Buffer,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
        field: (&wgpu::TextureView, &wgpu::Sampler),
    ) -> wgpu::BindGroup {
        self.kernel.bind(
            device,
            &[
                params.as_entire_binding(),
                guides.samples.as_entire_binding(),
                guides.sample_rest.as_entire_binding(),
                strands.bindings.as_entire_binding(),
                strands.rest.as_entire_binding(),
                strands.vertices.as_entire_binding(),
                wgpu::BindingResource::TextureView(field.0),
                wgpu::BindingResource::Sampler(field.1),
            ],
        )
    }

    /// Records the dispatch: one thread per strand.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, strands: &StrandBuffers) {
        self.kernel.record(pass, group, &[], strands.count.div_ceil(STRAND_WORKGROUP));
    }
}
