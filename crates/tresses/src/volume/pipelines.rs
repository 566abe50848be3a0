//! Pipelines of the stage.

use crate::{
    Context, collide,
    gpu::{Kernel, PipelineSet},
    shaders::kernels::volume as kernels,
};

/// The pipelines of the stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(super) obstacles: Kernel,
    pub(super) splat: Kernel,
    pub(super) sum: Kernel,
    pub(super) blur: [Kernel; 2],
    pub(super) density: Kernel,
    pub(super) push: Kernel,
    pub(super) settle: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let colliders = collide::layout(&context.device);
        let device = &context.device;
        Self {
            obstacles: Kernel::with_shared::<kernels::Obstacles>(device, &[&colliders]),
            splat: Kernel::new::<kernels::Splat>(device),
            sum: Kernel::new::<kernels::Sum>(device),
            blur: Kernel::each::<kernels::Blur, 2>(device, ["volume::blur_x", "volume::blur_y"]),
            density: Kernel::new::<kernels::Density>(device),
            push: Kernel::new::<kernels::Push>(device),
            settle: Kernel::new::<kernels::Settle>(device),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        let Self { obstacles, splat, sum, blur: [x, y], density, push, settle } = self;
        vec![obstacles, splat, sum, x, y, density, push, settle]
    }
}
