//! Pipelines of the stage, and the dispatches that use them.

use crate::{
    Context, collide,
    gpu::{ComputePass, Kernel, PipelineSet, bindings},
    shaders::kernels::wind as kernels,
};

/// The pipelines, created once per device.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(super) obstacles: Kernel,
    pub(super) predict: Kernel,
    pub(super) correct: Kernel,
    pub(super) gather: Kernel,
    pub(super) relax: Kernel,
    pub(super) project: Kernel,
    pub(super) smooth_level: Kernel,
    pub(super) coarse_solve: Kernel,
    pub(super) smooth_project: Kernel,
    pub(super) sampler: wgpu::Sampler,
    /// Whether the pressure is solved in blocks instead of levels.
    is_software: bool,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let device = &context.device;
        Self {
            obstacles: Kernel::with_shared::<kernels::Obstacles>(device, &[&collide::layout(device)]),
            predict: Kernel::new::<kernels::Predict>(device),
            correct: Kernel::new::<kernels::Correct>(device),
            gather: Kernel::new::<kernels::Gather>(device),
            relax: Kernel::new::<kernels::Relax>(device),
            project: Kernel::new::<kernels::Project>(device),
            smooth_level: Kernel::new::<kernels::SmoothLevel>(device),
            coarse_solve: Kernel::new::<kernels::CoarseSolve>(device),
            smooth_project: Kernel::new::<kernels::SmoothProject>(device),
            sampler: bindings::linear_sampler(device),
            is_software: context.tier().software,
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        let Self { obstacles, predict, correct, gather, relax, project, .. } = self;
        let Self { smooth_level, coarse_solve, smooth_project, .. } = self;
        let pressure = if self.is_software {
            [gather, relax, project]
        } else {
            [smooth_level, coarse_solve, smooth_project]
        };
        [[obstacles, predict, correct], pressure].concat()
    }
}

/// One dispatch of a step.
#[derive(Debug)]
pub(crate) struct Dispatch {
    pub kernel: fn(&Pipelines) -> &Kernel,
    pub group: wgpu::BindGroup,
    /// Workgroups along each axis.
    pub workgroups: [u32; 3],
    /// Whether it reads the uniforms of the step, which have a dynamic offset.
    pub is_stepped: bool,
}

impl Dispatch {
    /// Records the dispatch for the step whose uniforms are at `offset`.
    pub fn record(&self, pass: &mut ComputePass<'_>, pipelines: &Pipelines, offset: u32) {
        let offsets = &[offset][..usize::from(self.is_stepped)];
        (self.kernel)(pipelines).record_grid(pass, &self.group, offsets, self.workgroups);
    }
}

/// The dispatches that make the air divergence-free.
#[derive(Debug)]
pub(super) struct PressureSolve {
    /// In a step that starts from the last step's pressure.
    pub steady: Vec<Dispatch>,
    /// In a step that starts anew.
    pub fresh: Vec<Dispatch>,
    /// Bytes of GPU memory.
    pub bytes: u64,
}
