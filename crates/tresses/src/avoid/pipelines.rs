//! Host side of `first_hit.wesl`, `push_out.wesl` and `change_over.wesl`.

use super::AvoidMode;
use crate::{
    Context,
    collide::{self, ColliderSet},
    constants::{HIT_RUN, STRAND_WORKGROUP},
    gpu::{Binding, Kernel, PipelineSet},
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
        let Context { device, .. } = context;
        let colliders = collide::layout(device);
        let kernel = |module, storage: &[Binding]| {
            let entries = [&[Binding::Uniform], storage].concat();
            Kernel::beside(&context.device, module, &entries, &[&colliders])
        };
        let (read, write) = (Binding::Storage, Binding::StorageMut);
        Self {
            first_hit: kernel("avoid::first_hit", &[read, read, write]),
            push_out: kernel("avoid::push_out", &[read, write, write]),
            change_over: kernel("avoid::change_over", &[read, read, read, write, write]),
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
        params: &wgpu::Buffer,
        states: &wgpu::Buffer,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
    ) -> AvoidGroups {
        let bind = |kernel: &Kernel, buffers: &[&wgpu::Buffer]| {
            let buffers = [&[params], buffers].concat();
            kernel.bind(&buffers.iter().map(|b| b.as_entire_binding()).collect::<Vec<_>>())
        };
        let StrandBuffers { bindings, rest, vertices, .. } = strands;
        AvoidGroups {
            first_hit: bind(&self.first_hit, &[rest, vertices, states]),
            push_out: bind(&self.push_out, &[rest, vertices, states]),
            change_over: bind(&self.change_over, &[&guides.samples, bindings, rest, vertices, states]),
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
