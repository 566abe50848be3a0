//! Host side of `first_hit.wesl`, `push_out.wesl` and `change_over.wesl`.

use super::AvoidMode;
use crate::{
    Context,
    collide::{self, ColliderSet},
    constants::{HIT_RUN, STRAND_WORKGROUP},
    gpu::{BindBuffer, Kernel, PipelineSet, Uniform},
    shaders::kernels::avoid as kernels,
    strands::{GuideBuffers, StrandBuffers},
};

/// The stage's pipelines.
#[derive(Debug)]
pub(crate) struct Pipelines {
    first_hit: Kernel,
    push_out: Kernel,
    change_over: Kernel,
}

/// The bind groups of one groom.
#[derive(Debug)]
pub(crate) struct AvoidGroups {
    first_hit: wgpu::BindGroup,
    push_out: wgpu::BindGroup,
    change_over: wgpu::BindGroup,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let device = &context.device;
        let colliders = collide::layout(device);
        Self {
            first_hit: Kernel::with_shared::<kernels::FirstHit>(device, &[&colliders]),
            push_out: Kernel::with_shared::<kernels::PushOut>(device, &[&colliders]),
            change_over: Kernel::with_shared::<kernels::ChangeOver>(device, &[&colliders]),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.first_hit, &self.push_out, &self.change_over]
    }
}

impl Pipelines {
    /// Binds the stage to one groom. `params` is a uniform buffer of [`super::AvoidParams`], `states` has a
    /// [`super::StrandState`] per strand.
    pub fn bind(
        &self,
        params: &Uniform,
        states: &wgpu::Buffer,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
    ) -> AvoidGroups {
        let (params, states) = (params.entire(), states.entire());
        let (bindings, samples) = (strands.bindings.entire(), guides.samples.entire());
        let (rest, vertices) = (strands.rest.entire(), strands.vertices.entire());
        let change_over = kernels::ChangeOver { params, samples, bindings, rest, vertices, states };
        AvoidGroups {
            first_hit: self.first_hit.bind(&kernels::FirstHit { params, rest, vertices, states }),
            push_out: self.push_out.bind(&kernels::PushOut { params, rest, vertices, states }),
            change_over: self.change_over.bind(&change_over),
        }
    }

    /// Records the search, with one thread per run of a strand's vertices.
    pub(crate) fn record_first_hit(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        groups: &AvoidGroups,
        colliders: &ColliderSet,
        strands: &StrandBuffers,
    ) {
        pass.set_bind_group(1, colliders.group(), &[]);
        let runs = strands.drawn.vertex_count.div_ceil(HIT_RUN);
        let workgroups = strands.drawn.count.div_ceil(STRAND_WORKGROUP) * runs;
        self.first_hit.record(pass, &groups.first_hit, &[], workgroups);
    }

    /// Records the search and the correction, with one thread per strand. Does nothing with [`AvoidMode::Off`].
    pub fn record(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        groups: &AvoidGroups,
        colliders: &ColliderSet,
        strands: &StrandBuffers,
        mode: AvoidMode,
    ) {
        let (kernel, group) = match mode {
            AvoidMode::Off => return,
            AvoidMode::PenetratingOnly => (&self.push_out, &groups.push_out),
            AvoidMode::ChangeOver => (&self.change_over, &groups.change_over),
        };
        self.record_first_hit(pass, groups, colliders, strands);
        kernel.record(pass, group, &[], strands.drawn.count.div_ceil(STRAND_WORKGROUP));
    }
}
