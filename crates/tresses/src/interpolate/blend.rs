//! Host side of `blend.wesl`.

use crate::{
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Kernel},
    strands::{GuideBuffers, StrandBuffers},
};
use bytemuck::{Pod, Zeroable};

/// The uniform of the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct InterpolateParams {
    /// Number of strands.
    pub strand_count: u32,
    /// Vertices of a drawn strand, at least 2.
    pub vertex_count: u32,
    /// Samples per guide, at least 2.
    pub sample_count: u32,
    /// Vertices of a strand's rest curve, at least 2.
    pub rest_count: u32,
    /// See [`crate::strands::Drawn::stride`].
    pub stride: f32,
    /// Unused.
    pub _pad_a: u32,
    /// Unused.
    pub _pad_b: u32,
    /// Unused.
    pub _pad_c: u32,
}

impl InterpolateParams {
    /// For what is drawn of `strands`.
    pub fn new(guides: &GuideBuffers, strands: &StrandBuffers) -> Self {
        Self {
            strand_count: strands.drawn.count,
            vertex_count: strands.drawn.vertex_count,
            sample_count: guides.sample_count,
            rest_count: strands.vertex_count,
            stride: strands.drawn.stride,
            ..Self::default()
        }
    }
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
        ];
        Self { kernel: Kernel::new(device, "interpolate::blend", &entries) }
    }

    /// All of them.
    pub(crate) fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.kernel]
    }

    /// Binds the stage to one groom and a uniform buffer of [`InterpolateParams`].
    pub fn bind(
        &self,
        device: &wgpu::Device,
        params: &wgpu::Buffer,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
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
            ],
        )
    }

    /// Records the dispatch: one thread per strand.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, strands: &StrandBuffers) {
        self.kernel.record(pass, group, &[], strands.drawn.count.div_ceil(STRAND_WORKGROUP));
    }
}
