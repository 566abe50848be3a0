//! Every pipeline of a device, each compiled when it is first needed or when it is asked for in advance.

use crate::{
    Progress, Result, avoid, collide, draw,
    gpu::{
        kernel::{self, Job},
        pipeline::Scopes,
    },
    interpolate,
    light::{self, ShadingRate},
    lod::Widths,
    present, roots, simulate, skinning,
    stage::Stage,
    tessellate,
    view::ViewOptions,
    volume, wind,
};

/// Every pipeline; one of it per device. To make it costs next to nothing: a pipeline is compiled when a frame first
/// records it, or by [`prepare`](Self::prepare).
#[derive(Debug)]
pub struct Pipelines {
    device: wgpu::Device,
    /// Bodies bend.
    pub skinning: skinning::Pipelines,
    /// Roots go with skin.
    pub roots: roots::Pipelines,
    /// Fields deform with skin.
    pub deform: collide::deform::Pipelines,
    /// Guides fill a grid.
    pub volume: volume::Pipelines,
    /// Air moves.
    pub wind: wind::Pipelines,
    /// Guides move.
    pub simulate: simulate::Pipelines,
    /// Guides become curves.
    pub tessellate: tessellate::Pipelines,
    /// Guides become strands.
    pub interpolate: interpolate::Pipelines,
    /// Strands leave obstacles.
    pub avoid: avoid::Pipelines,
    /// Widths of strands at a level of detail.
    pub widths: Widths,
    /// How much light arrives, and what comes back.
    pub light: light::Pipelines,
    /// Bodies and hair into the HDR target.
    pub draw: draw::Pipelines,
    /// The finished picture.
    pub present: present::Pipelines,
}

/// What can be compiled in advance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wanted {
    /// A stage that moves hair; of `simulate`, what does not depend on the size of guides.
    Motion(Stage),
    /// The step of `simulate` for guides of so many vertices.
    Step(u32),
    /// The same for hair that twists.
    Twist(u32),
    /// All that a view with these options draws with, hair shaded so.
    Picture(ViewOptions, ShadingRate),
}

impl Pipelines {
    /// For `device`, none compiled yet.
    pub fn new(device: &wgpu::Device) -> Self {
        let light = light::Pipelines::new(device);
        Self {
            device: device.clone(),
            skinning: skinning::Pipelines::new(device),
            roots: roots::Pipelines::new(device),
            deform: collide::deform::Pipelines::new(device),
            volume: volume::Pipelines::new(device),
            wind: wind::Pipelines::new(device),
            simulate: simulate::Pipelines::new(device),
            tessellate: tessellate::Pipelines::new(device),
            interpolate: interpolate::Pipelines::new(device),
            avoid: avoid::Pipelines::new(device),
            widths: Widths::new(device),
            draw: draw::Pipelines::new(device, &light),
            light,
            present: present::Pipelines::new(device),
        }
    }

    /// The layout of [`View::light_group`](crate::View::light_group), for pipelines of others.
    pub fn light_layout(&self) -> &wgpu::BindGroupLayout {
        &self.light.frame
    }

    /// Compiles what is wanted and is not there yet, several at once where the platform has threads, telling
    /// `progress`. In a browser this is how to learn of errors; what a frame compiles there on its own is
    /// recorded unseen.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] with what wgpu said of the first that failed.
    pub async fn prepare(&self, wanted: &[Wanted], progress: &impl Progress) -> Result<()> {
        const TASK: &str = "compiling shaders";
        let mut jobs: Vec<Job<'_>> = wanted.iter().flat_map(|wanted| self.jobs(wanted)).collect();
        let count = jobs.len().max(1);
        let threads = crate::progress::threads();
        let mut done = 0;
        while !jobs.is_empty() {
            progress.step(TASK, done as f32 / count as f32).await;
            let batch: Vec<_> = jobs.drain(..threads.min(jobs.len())).collect();
            done += batch.len();
            // Scopes belong to threads: jobs open their own, but for those of a browser, where answers come later.
            let scopes = cfg!(target_arch = "wasm32").then(|| Scopes::open(&self.device));
            run(&batch)?;
            if let Some(scopes) = scopes {
                scopes.close(TASK).await?;
            }
        }
        progress.step(TASK, 1.0).await;
        Ok(())
    }

    fn jobs(&self, wanted: &Wanted) -> Vec<Job<'_>> {
        match wanted {
            Wanted::Step(vertex_count) => kernel::jobs([self.simulate.step(*vertex_count)]),
            Wanted::Twist(vertex_count) => kernel::jobs([self.simulate.twist(*vertex_count)]),
            Wanted::Motion(stage) => match stage {
                Stage::Skinning => kernel::jobs(self.skinning.kernels()),
                Stage::Roots => kernel::jobs(self.roots.kernels().into_iter().chain(self.deform.kernels())),
                Stage::Volume => kernel::jobs(self.volume.kernels()),
                Stage::Wind => kernel::jobs(self.wind.kernels()),
                Stage::Simulate => kernel::jobs(self.simulate.kernels()),
                Stage::Tessellate => kernel::jobs(self.tessellate.kernels()),
                Stage::Interpolate => {
                    kernel::jobs(self.interpolate.kernels().into_iter().chain(self.widths.kernels()))
                }
                Stage::Avoid => kernel::jobs(self.avoid.kernels()),
                Stage::Light | Stage::Draw | Stage::Present => Vec::new(),
            },
            Wanted::Picture(options, rate) => {
                let ViewOptions { samples, coverage, output, strand_map, .. } = *options;
                let mut jobs = self.light.jobs(coverage.is_tiled(), strand_map > 0);
                jobs.extend(self.draw.jobs(coverage, samples, *rate));
                // How many times larger than the picture targets are is not known yet: mostly they are not.
                jobs.push(Box::new(move || self.present.get(coverage, (samples, 1), output).map(|_| ())));
                jobs
            }
        }
    }
}

/// Runs all of `jobs`, at once where there are threads.
fn run(jobs: &[Job<'_>]) -> Result<()> {
    #[cfg(target_arch = "wasm32")]
    return jobs.iter().try_for_each(|job| job());
    #[cfg(not(target_arch = "wasm32"))]
    std::thread::scope(|scope| {
        let running: Vec<_> = jobs.iter().map(|job| scope.spawn(job)).collect();
        running.into_iter().try_for_each(|job| {
            // A panic of a job is one of whoever asked for it.
            job.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    })
}
