//! The kernels of grabs and brushes.

use super::GrabUniform;
use crate::{
    Context, collide,
    gpu::{Binding, Kernel},
    strands::{GuideBuffers, StrandBuffers},
};

/// The grab's pipelines.
#[derive(Debug)]
pub(crate) struct GrabKernels {
    pick: Kernel,
    hit: Kernel,
    reach: Kernel,
    hold: Kernel,
    aim: Kernel,
    pull: Kernel,
    sweep: Kernel,
}

/// Bind groups of each kernel for one groom.
#[derive(Debug)]
pub(crate) struct Groups {
    pick: wgpu::BindGroup,
    hit: wgpu::BindGroup,
    reach: wgpu::BindGroup,
    hold: wgpu::BindGroup,
    aim: wgpu::BindGroup,
    pull: wgpu::BindGroup,
    sweep: wgpu::BindGroup,
}

impl GrabKernels {
    pub fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        use Binding::{Storage, StorageMut, UniformDynamic};
        let obstacles = collide::layout(device);
        let kernel = |name, entries: &[Binding]| Kernel::new(&context.device, name, entries);
        let beside =
            |name, entries: &[Binding]| Kernel::beside(&context.device, name, entries, &[&obstacles]);
        Self {
            pick: kernel("simulate::grab::pick", &[UniformDynamic, StorageMut, Storage]),
            hit: beside("simulate::grab::hit", &[UniformDynamic, StorageMut, StorageMut]),
            reach: kernel("simulate::grab::reach", &[UniformDynamic, StorageMut, Storage, Storage]),
            hold: kernel("simulate::grab::hold", &[UniformDynamic, StorageMut, Storage, Storage, StorageMut]),
            aim: kernel("simulate::grab::aim", &[UniformDynamic, StorageMut]),
            pull: beside(
                "simulate::grab::pull",
                &[UniformDynamic, Storage, Storage, Storage, Storage, StorageMut],
            ),
            sweep: beside(
                "simulate::grab::sweep",
                &[UniformDynamic, StorageMut, Storage, Storage, Storage, StorageMut],
            ),
        }
    }

    /// Binds the kernels. `own` is uniforms, marks, state and holds.
    pub fn bind(&self, own: [&wgpu::Buffer; 4], guides: &GuideBuffers, strands: &StrandBuffers) -> Groups {
        let [uniforms, marks, state, holds] = own;
        let bind = |kernel: &Kernel, buffers: &[&wgpu::Buffer]| {
            let uniform = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: uniforms,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<GrabUniform>() as u64),
            });
            let buffers = buffers.iter().map(|buffer| buffer.as_entire_binding());
            kernel.bind(&std::iter::once(uniform).chain(buffers).collect::<Vec<_>>())
        };
        Groups {
            pick: bind(&self.pick, &[marks, &strands.vertices]),
            hit: bind(&self.hit, &[marks, state]),
            reach: bind(&self.reach, &[marks, state, &guides.current]),
            hold: bind(&self.hold, &[marks, state, &guides.current, holds]),
            aim: bind(&self.aim, &[state]),
            pull: bind(&self.pull, &[state, holds, &guides.current, &guides.velocity, &guides.forces]),
            sweep: bind(&self.sweep, &[marks, state, &guides.current, &guides.velocity, &guides.forces]),
        }
    }

    /// Records the kernels of a step. `workgroups` are the counts for strand vertices and for guide vertices; `picks`
    /// casts the ray, `sweeps` is true for a brush.
    pub fn record(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        groups: &Groups,
        workgroups: [u32; 2],
        offset: u32,
        (picks, sweeps): (bool, bool),
    ) {
        let at = &[offset];
        let [strands, guides] = workgroups;
        if picks {
            self.pick.record(pass, &groups.pick, at, strands);
            self.hit.record(pass, &groups.hit, at, 1);
            self.reach.record(pass, &groups.reach, at, guides);
            if !sweeps {
                self.hold.record(pass, &groups.hold, at, guides);
            }
        }
        self.aim.record(pass, &groups.aim, at, 1);
        if sweeps {
            self.sweep.record(pass, &groups.sweep, at, guides);
        } else {
            self.pull.record(pass, &groups.pull, at, guides);
        }
    }
}
