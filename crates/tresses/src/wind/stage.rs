//! The pipelines of the fluid and the order in which one step runs them.

use super::air::Air;
use crate::gpu::{Binding, Kernel};

/// The pipelines; made once per device.
#[derive(Debug)]
pub struct Fluid {
    pub(super) obstacles: Kernel,
    pub(super) predict: Kernel,
    pub(super) correct: Kernel,
    pub(super) divergence: Kernel,
    pub(super) relax: Kernel,
    pub(super) project: Kernel,
    pub(super) sampler: wgpu::Sampler,
}

impl Fluid {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        use Binding::{Sampler, Storage, StorageMut, Texture3d, UniformDynamic, Write3d};
        let kernel = |module, entries: &[Binding]| Kernel::new(device, module, entries);
        Self {
            obstacles: kernel(
                "wind::obstacles",
                &[UniformDynamic, Texture3d, Texture3d, Sampler, StorageMut, StorageMut],
            ),
            predict: kernel("wind::predict", &[UniformDynamic, Storage, Storage, StorageMut]),
            correct: kernel(
                "wind::correct",
                &[UniformDynamic, Storage, Storage, Storage, Storage, Storage, StorageMut, StorageMut],
            ),
            divergence: kernel(
                "wind::divergence",
                &[UniformDynamic, Storage, Storage, StorageMut, StorageMut],
            ),
            relax: kernel("wind::relax", &[UniformDynamic, UniformDynamic, Storage, Storage, StorageMut]),
            project: kernel(
                "wind::project",
                &[UniformDynamic, Storage, Storage, Storage, StorageMut, StorageMut, StorageMut, Write3d],
            ),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("wind"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        }
    }

    /// Records step `index` of those that [`Air::prepare`] wrote.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, air: &Air, index: usize) {
        let step = air.offset(index);
        let groups = air.cells.div_ceil(8);
        let all = [groups, air.cells.div_ceil(4), air.cells.div_ceil(2)];
        self.obstacles.record_grid(pass, &air.groups.obstacles, &[step], all);
        self.predict.record_grid(pass, &air.groups.predict, &[step], all);
        self.correct.record_grid(pass, &air.groups.correct, &[step], all);
        self.divergence.record_grid(pass, &air.groups.divergence, &[step], all);
        let half = [air.cells.div_ceil(16), all[1], all[2]];
        for sweep in 0..2 * air.sweeps(index) {
            let parity = air.parity(sweep % 2);
            self.relax.record_grid(pass, &air.groups.relax, &[step, parity], half);
        }
        self.project.record_grid(pass, &air.groups.project, &[step], all);
    }
}
