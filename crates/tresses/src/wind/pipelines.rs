//! Pipelines of the stage.

use crate::{
    Context, collide,
    gpu::{Binding, Kernel, PipelineSet, bindings},
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
        let Context { device, .. } = context;
        use Binding::{
            Sampler, StorageDynamic, Texels3d, Texture3d, Uniform, UniformDynamic, Write3d, WriteFull3d,
        };
        let kernel = |module, entries: &[Binding]| Kernel::new(&context.device, module, entries);
        let air = [StorageDynamic, Texture3d, Texture3d, Sampler];
        let blocks = [UniformDynamic, Uniform, Texels3d, Texels3d, Texels3d, Texels3d, Texels3d];
        Self {
            obstacles: Kernel::beside(
                &context.device,
                "wind::obstacles",
                &[StorageDynamic, Texture3d, Sampler, Write3d, Write3d],
                &[&collide::layout(device)],
            ),
            predict: kernel("wind::predict", &[&air[..], &[Write3d]].concat()),
            correct: kernel(
                "wind::correct",
                &[&air[..], &[Texture3d, Texture3d, Texture3d, WriteFull3d, Write3d]].concat(),
            ),
            gather: kernel(
                "wind::gather",
                &[UniformDynamic, Texels3d, Texels3d, Write3d, Write3d, Write3d, WriteFull3d],
            ),
            relax: kernel("wind::relax", &[&blocks[..], &[Texels3d, WriteFull3d]].concat()),
            project: kernel(
                "wind::project",
                &[&blocks[..], &[Texels3d, Write3d, Write3d, Texels3d, Write3d]].concat(),
            ),
            sampler: bindings::linear(device),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        let Self { obstacles, predict, correct, gather, relax, project, .. } = self;
        vec![obstacles, predict, correct, gather, relax, project]
    }
}
