//! The kernels of grabs and brushes.

use super::GrabUniform;
use crate::{
    Context, collide,
    gpu::{BindBuffer, Kernel, Uniform},
    shaders::kernels::simulate::grab as kernels,
    strands::{GuideBuffers, StrandBuffers},
};

/// The grab's pipelines.
#[derive(Debug)]
pub(crate) struct GrabKernels {
    pick: Kernel,
    hit: Kernel,
    min_distance: Kernel,
    hold: Kernel,
    move_target: Kernel,
    pull: Kernel,
    sweep: Kernel,
}

/// Buffers of a grab.
#[derive(Debug)]
pub(crate) struct GrabBuffers {
    /// A [`GrabUniform`] per step.
    pub uniforms: Uniform,
    pub marks: wgpu::Buffer,
    pub state: wgpu::Buffer,
    pub holds: wgpu::Buffer,
}

/// Bind groups of each kernel for one groom.
#[derive(Debug)]
pub(crate) struct Groups {
    pick: wgpu::BindGroup,
    hit: wgpu::BindGroup,
    min_distance: wgpu::BindGroup,
    hold: wgpu::BindGroup,
    move_target: wgpu::BindGroup,
    pull: wgpu::BindGroup,
    sweep: wgpu::BindGroup,
}

impl GrabKernels {
    pub fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let obstacles = collide::layout(device);
        let device = &context.device;
        Self {
            pick: Kernel::new::<kernels::Pick>(device),
            hit: Kernel::with_shared::<kernels::Hit>(device, &[&obstacles]),
            min_distance: Kernel::new::<kernels::MinDistance>(device),
            hold: Kernel::new::<kernels::Hold>(device),
            move_target: Kernel::new::<kernels::MoveTarget>(device),
            pull: Kernel::with_shared::<kernels::Pull>(device, &[&obstacles]),
            sweep: Kernel::with_shared::<kernels::Sweep>(device, &[&obstacles]),
        }
    }

    /// Binds the kernels to one groom.
    pub fn bind(&self, own: &GrabBuffers, guides: &GuideBuffers, strands: &StrandBuffers) -> Groups {
        let u = own.uniforms.part(0, Some(size_of::<GrabUniform>() as u64));
        let (marks, state) = (own.marks.entire(), own.state.entire());
        let (holds, forces) = (own.holds.entire(), guides.forces.entire());
        let (current, velocity) = (guides.current.entire(), guides.velocity.entire());
        let vertices = strands.vertices.entire();
        Groups {
            pick: self.pick.bind(&kernels::Pick { u, marks, vertices }),
            hit: self.hit.bind(&kernels::Hit { u, marks, state }),
            min_distance: self.min_distance.bind(&kernels::MinDistance { u, marks, state, current }),
            hold: self.hold.bind(&kernels::Hold { u, marks, state, current, holds }),
            move_target: self.move_target.bind(&kernels::MoveTarget { u, state }),
            pull: self.pull.bind(&kernels::Pull { u, state, holds, current, velocity, forces }),
            sweep: self.sweep.bind(&kernels::Sweep { u, marks, state, current, velocity, forces }),
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
            self.min_distance.record(pass, &groups.min_distance, at, guides);
            if !sweeps {
                self.hold.record(pass, &groups.hold, at, guides);
            }
        }
        self.move_target.record(pass, &groups.move_target, at, 1);
        if sweeps {
            self.sweep.record(pass, &groups.sweep, at, guides);
        } else {
            self.pull.record(pass, &groups.pull, at, guides);
        }
    }
}
