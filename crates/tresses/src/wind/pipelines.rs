//! Pipelines of the stage.

use crate::{
    Context, collide,
    gpu::{Kernel, PipelineSet, bindings},
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
    pub(super) sampler: wgpu::Sampler,
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
            sampler: bindings::linear_sampler(device),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        let Self { obstacles, predict, correct, gather, relax, project, .. } = self;
        vec![obstacles, predict, correct, gather, relax, project]
    }
}
