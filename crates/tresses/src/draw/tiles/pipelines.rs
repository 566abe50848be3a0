//! Kernels of the compute rasterizer, each compiled at first use.

use crate::Context;
use crate::gpu::{
    Binding::{
        self, Depth, DepthMultisampled, Storage, StorageMut, Texels2d, Uniform, UniformDynamic, Words2d,
        Write2d, WriteFloats2d, WriteWords2d,
    },
    Kernel,
    kernel::{self, Job},
};

/// Kernels in the order in which they run.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub project: Kernel,
    /// Indexed by whether targets have several samples per pixel.
    pub surface: [Kernel; 2],
    pub bound: Kernel,
    pub count: Kernel,
    pub totals: Kernel,
    pub scan: Kernel,
    pub scatter: Kernel,
    pub sort: Kernel,
    pub merge: Kernel,
    pub rewind: Kernel,
    pub touch: Kernel,
    /// Indexed by whether pixels have two surfaces, that is, several samples.
    pub see: [Kernel; 2],
    pub deepen: Kernel,
    pub tint: Kernel,
    /// As `see`; compiled only if geometry is requested.
    pub geometry: [Kernel; 2],
    /// As `see`; compiled only if labels are requested.
    pub label: [Kernel; 2],
    /// As `see`.
    pub blend: [Kernel; 2],
}

impl Pipelines {
    pub fn new(context: &Context) -> Self {
        let kernel = |module, bindings: &[Binding]| Kernel::new(&context.device, module, bindings);
        let asked = [Storage, Storage, Storage, StorageMut, UniformDynamic];
        let sort = [&asked[..], &[Storage, Storage, WriteWords2d]].concat();
        let merge = [&asked[..], &[Storage, StorageMut, WriteWords2d]].concat();
        let touch = [&asked[..], &[Words2d, Texels2d, StorageMut]].concat();
        let lists = [Storage, Storage, Storage, Words2d, Texels2d];
        let see = [&lists[..], &[StorageMut, StorageMut, StorageMut, UniformDynamic, StorageMut]].concat();
        let of_rows = [&lists[..], &[StorageMut, StorageMut]].concat();
        let geometry = [&of_rows[..], &[Texels2d, UniformDynamic, Storage, WriteFloats2d]].concat();
        let label = [&of_rows[..], &[WriteFloats2d, UniformDynamic]].concat();
        let blend = [&lists[..], &[StorageMut, StorageMut, Words2d, UniformDynamic, Write2d]].concat();
        Self {
            surface: [
                kernel("draw::tiles::surface_one", &[Storage, Storage, Depth, StorageMut, StorageMut]),
                kernel(
                    "draw::tiles::surface_many",
                    &[Storage, Storage, DepthMultisampled, StorageMut, StorageMut, Uniform],
                ),
            ],
            project: kernel(
                "draw::tiles::project",
                &[Uniform, Storage, Storage, Storage, Storage, WriteFloats2d, StorageMut],
            ),
            bound: kernel("draw::tiles::bound", &[Storage, Storage, Storage, StorageMut]),
            count: kernel("draw::tiles::count", &[Storage, Texels2d, Words2d, StorageMut]),
            totals: kernel("draw::tiles::totals", &[Storage, StorageMut, StorageMut]),
            scan: kernel("draw::tiles::scan", &[Storage, StorageMut, StorageMut, StorageMut, StorageMut]),
            scatter: kernel(
                "draw::tiles::scatter",
                &[Storage, Texels2d, Words2d, StorageMut, StorageMut, UniformDynamic],
            ),
            sort: kernel("draw::tiles::sort", &sort),
            merge: kernel("draw::tiles::merge", &merge),
            rewind: kernel("draw::tiles::rewind", &[Storage, Storage, StorageMut, UniformDynamic]),
            touch: kernel("draw::tiles::touch", &touch),
            see: ["draw::tiles::see::1", "draw::tiles::see::2"].map(|module| kernel(module, &see)),
            geometry: ["draw::tiles::geometry::1", "draw::tiles::geometry::2"]
                .map(|module| kernel(module, &geometry)),
            label: ["draw::tiles::label::1", "draw::tiles::label::2"].map(|module| kernel(module, &label)),
            deepen: kernel("draw::tiles::deepen", &[StorageMut, Storage, UniformDynamic]),
            tint: kernel("draw::tiles::tint", &[Storage, Storage, Storage, WriteWords2d]),
            blend: ["draw::tiles::blend::1", "draw::tiles::blend::2"].map(|module| kernel(module, &blend)),
        }
    }

    /// Returns jobs that compile the kernels for targets with `samples` per pixel.
    pub fn jobs(&self, samples: u32) -> Vec<Job<'_>> {
        let many = usize::from(samples > 1);
        kernel::jobs([
            &self.project,
            &self.surface[many],
            &self.bound,
            &self.count,
            &self.totals,
            &self.scan,
            &self.scatter,
            &self.sort,
            &self.merge,
            &self.rewind,
            &self.touch,
            &self.see[many],
            &self.deepen,
            &self.tint,
            &self.blend[many],
        ])
    }
}
