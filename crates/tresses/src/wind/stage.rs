//! The pipelines of the fluid and the order in which one step runs them.

use super::air::{Air, STRIDE};
use crate::{
    collide::{self, ColliderSet},
    gpu::{Binding, Kernel, bindings},
};

/// The pipelines; made once per device.
#[derive(Debug)]
pub struct Fluid {
    pub(super) obstacles: Kernel,
    pub(super) predict: Kernel,
    pub(super) correct: Kernel,
    pub(super) gather: Kernel,
    pub(super) relax: Kernel,
    pub(super) project: Kernel,
    pub(super) sampler: wgpu::Sampler,
}

impl Fluid {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        use Binding::{
            Sampler, StorageDynamic, Texels3d, Texture3d, Uniform, UniformDynamic, Write3d, WriteFull3d,
        };
        let kernel = |module, entries: &[Binding]| Kernel::new(device, module, entries);
        let air = [StorageDynamic, Texture3d, Texture3d, Sampler];
        let blocks = [UniformDynamic, Uniform, Texels3d, Texels3d, Texels3d, Texels3d, Texels3d];
        Self {
            obstacles: Kernel::beside(
                device,
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

    /// All of them.
    pub(crate) fn kernels(&self) -> Vec<&Kernel> {
        let Self { obstacles, predict, correct, gather, relax, project, .. } = self;
        vec![obstacles, predict, correct, gather, relax, project]
    }

    /// Records step `index` of those that [`Air::prepare`] wrote, among `colliders`, which have been
    /// [advanced](ColliderSet::advance) by the same steps.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, air: &Air, colliders: &ColliderSet, index: u32) {
        let (run, groups, n) = (air.run(index), &air.groups, air.cells);
        let cells = [n / 8, n / 4, n / 2];
        let half = [n.div_ceil(32), n / 8, n / 2];
        pass.set_bind_group(1, colliders.group(), &[]);
        for part in 0..run.parts {
            let step = (run.first + part) * STRIDE as u32;
            if part == 0 {
                self.obstacles.record_grid(pass, &groups.obstacles, &[step], cells);
            }
            self.predict.record_grid(pass, &groups.predict, &[step], cells);
            self.correct.record_grid(pass, &groups.correct, &[step], cells);
            self.gather.record_grid(pass, &groups.gather, &[step], [n.div_ceil(32), n / 4, n / 2]);
            let fresh = run.fresh && part == 0;
            for sweep in air.sweeps(fresh) {
                for color in &groups.relax[sweep as usize] {
                    self.relax.record_grid(pass, color, &[step], half);
                }
            }
            for color in &groups.project {
                self.project.record_grid(pass, color, &[step], half);
            }
        }
    }
}
