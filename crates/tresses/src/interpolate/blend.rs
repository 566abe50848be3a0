//! Host side of `blend.wesl` and `follow.wesl`.

use crate::{
    Context,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, Kernel, PipelineSet, Uniform},
    shaders::kernels::interpolate as kernels,
    strands::{GuideBuffers, StrandBuffers},
    tessellate::Tessellation,
};
use bytemuck::{Pod, Zeroable};
use std::sync::Arc;

/// The uniform of the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct InterpolateParams {
    /// Number of strands.
    pub strand_count: u32,
    /// Vertices of a drawn strand, at least 2.
    pub vertex_count: u32,
    /// Samples per guide, at least 2; 0 if each strand follows its own guide.
    pub sample_count: u32,
    /// Vertices of a strand's rest curve, at least 2.
    pub rest_count: u32,
    /// See [`crate::strands::DrawCount::stride`].
    pub stride: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

impl InterpolateParams {
    /// Creates the parameters for the drawn part of `strands`.
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

/// The pipelines of the stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    blend: Kernel,
    follow: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let device = &context.device;
        Self { blend: Kernel::new::<kernels::Blend>(device), follow: Kernel::new::<kernels::Follow>(device) }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.blend, &self.follow]
    }
}

/// The stage's state for one groom.
#[derive(Debug)]
pub(crate) struct Interpolation {
    pipelines: Arc<Pipelines>,
    params: Uniform,
    group: wgpu::BindGroup,
    follows: bool,
}

impl Interpolation {
    /// Creates the stage for `strands` that are blended between `guides` with samples.
    pub fn new(context: &Context, guides: &GuideBuffers, strands: &StrandBuffers) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let params = device.uniform(size_of::<InterpolateParams>());
        let group = pipelines.blend.bind(&kernels::Blend {
            params: params.entire(),
            samples: guides.samples.entire(),
            bindings: strands.bindings.entire(),
            rest: strands.rest.entire(),
            vertices: strands.vertices.entire(),
            roots: strands.roots.entire(),
        });
        Self { pipelines, params, group, follows: false }
    }

    /// Creates the stage for `strands` that each follow one of `guides`, in the state that `tessellation` computes per
    /// frame.
    pub fn following(
        context: &Context,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
        tessellation: &Tessellation,
    ) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let params = device.uniform(size_of::<InterpolateParams>());
        let group = pipelines.follow.bind(&kernels::Follow {
            walk: tessellation.walk(guides),
            drawn: params.entire(),
            bindings: strands.bindings.entire(),
            curves: strands.rest.entire(),
            vertices: strands.vertices.entire(),
        });
        Self { group, pipelines, params, follows: true }
    }

    /// Writes the uniform of a frame for the drawn part of `strands`.
    pub fn prepare(&self, guides: &GuideBuffers, strands: &StrandBuffers) {
        let params = InterpolateParams::new(guides, strands);
        self.params.write(0, bytemuck::bytes_of(&params));
    }

    /// Records the stage: one thread per strand.
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, strands: &StrandBuffers) {
        let kernel = if self.follows { &self.pipelines.follow } else { &self.pipelines.blend };
        kernel.record(pass, &self.group, &[], strands.drawn.count.div_ceil(STRAND_WORKGROUP));
    }
}
