//! Pipelines of the stage.

use crate::{
    Context, collide,
    gpu::{Binding, Kernel, PipelineSet},
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
        let Context { device, .. } = context;
        use Binding::{
            Storage as Read, StorageMut as Write, Uniform as Always, UniformDynamic as Uniform, Words3d,
            Write3d, WriteWords3d,
        };
        let kernel = |name, entries: &[Binding]| Kernel::new(&context.device, name, entries);
        let colliders = collide::layout(device);
        Self {
            obstacles: Kernel::beside(&context.device, "volume::obstacles", &[Uniform, Write], &[&colliders]),
            splat: kernel("volume::splat", &[Uniform, Read, Read, Read, Read, Read, Write]),
            sum: kernel("volume::sum", &[Uniform, Write, Read, WriteWords3d]),
            blur: ["volume::blur_x", "volume::blur_y"]
                .map(|name| kernel(name, &[Uniform, Always, Words3d, WriteWords3d])),
            density: kernel("volume::density", &[Uniform, Always, Words3d, Write, WriteWords3d, Write3d]),
            push: kernel("volume::push", &[Uniform, Words3d, Write3d]),
            settle: kernel("volume::settle", &[Uniform, Read, Read, Write, Read]),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        let Self { obstacles, splat, sum, blur: [x, y], density, push, settle } = self;
        vec![obstacles, splat, sum, x, y, density, push, settle]
    }
}
