//! Kernels of the compute rasterizer, each compiled at first use.

use crate::Context;
use crate::gpu::{
    Kernel,
    kernel::{self, Job},
};
use crate::shaders::kernels::draw::tiles as kernels;

/// Kernels in the order in which they run.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub project: Kernel,
    /// Indexed by whether targets have several samples per pixel.
    pub surface: [Kernel; 2],
    pub bound: Kernel,
    pub totals: Kernel,
    pub scan: Kernel,
    pub scatter: Kernel,
    pub sort: Kernel,
    pub merge: Kernel,
    pub reset_bins: Kernel,
    pub touch: Kernel,
    /// Indexed by whether pixels have two surfaces, that is, several samples.
    pub visibility: [Kernel; 2],
    pub dispatch_deep: Kernel,
    pub tint: Kernel,
    /// As `visibility`; compiled only if geometry is requested.
    pub geometry: [Kernel; 2],
    /// As `visibility`; compiled only if labels are requested.
    pub label: [Kernel; 2],
    /// As `visibility`.
    pub blend: [Kernel; 2],
}

impl Pipelines {
    pub fn new(context: &Context) -> Self {
        let device = &context.device;
        Self {
            surface: [
                Kernel::new::<kernels::SurfaceOne>(device),
                Kernel::new::<kernels::SurfaceMany>(device),
            ],
            project: Kernel::new::<kernels::Project>(device),
            bound: Kernel::new::<kernels::Bound>(device),
            totals: Kernel::new::<kernels::Totals>(device),
            scan: Kernel::new::<kernels::Scan>(device),
            scatter: Kernel::new::<kernels::Scatter>(device),
            sort: Kernel::new::<kernels::Sort>(device),
            merge: Kernel::new::<kernels::Merge>(device),
            reset_bins: Kernel::new::<kernels::ResetBins>(device),
            touch: Kernel::new::<kernels::Touch>(device),
            visibility: Kernel::each::<kernels::Visibility, 2>(
                device,
                ["draw::tiles::visibility::1", "draw::tiles::visibility::2"],
            ),
            geometry: Kernel::each::<kernels::Geometry, 2>(
                device,
                ["draw::tiles::geometry::1", "draw::tiles::geometry::2"],
            ),
            label: Kernel::each::<kernels::Label, 2>(
                device,
                ["draw::tiles::label::1", "draw::tiles::label::2"],
            ),
            dispatch_deep: Kernel::new::<kernels::DispatchDeep>(device),
            tint: Kernel::new::<kernels::Tint>(device),
            blend: Kernel::each::<kernels::Blend, 2>(
                device,
                ["draw::tiles::blend::1", "draw::tiles::blend::2"],
            ),
        }
    }

    /// Returns jobs that compile the kernels for targets with `samples` per pixel.
    pub fn jobs(&self, samples: u32) -> Vec<Job<'_>> {
        let many = usize::from(samples > 1);
        kernel::jobs([
            &self.project,
            &self.surface[many],
            &self.bound,
            &self.totals,
            &self.scan,
            &self.scatter,
            &self.sort,
            &self.merge,
            &self.reset_bins,
            &self.touch,
            &self.visibility[many],
            &self.dispatch_deep,
            &self.tint,
            &self.blend[many],
        ])
    }
}
