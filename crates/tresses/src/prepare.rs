//! Compiling pipelines in advance.

use crate::{
    Context, Progress, Result, avoid, collide, draw, gpu::kernel::Job, hair::Curves, light, lod, present,
    roots, simulate, skinning, view::ViewOptions, volume, wind,
};
use std::sync::Arc;

#[cfg(target_arch = "wasm32")]
use crate::gpu::pipeline::Scopes;

/// Pipelines to compile with [`Context::prepare`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PipelineRequest {
    /// Skinned meshes.
    Skinning,
    /// Roots that follow a mesh, and fields that deform with it.
    Roots,
    /// Self-collision.
    Volume,
    /// Wind.
    Wind,
    /// Forces of self-collision and wind on guides.
    Forces,
    /// The simulation step for guides with this number of vertices.
    Step(u32),
    /// The simulation step with twist for guides with this number of vertices.
    TwistStep(u32),
    /// Strands that follow guides, and strand widths.
    Strands,
    /// Strand collision.
    Avoid,
    /// Cards in a view with this number of samples per pixel.
    Cards(u32),
    /// All pipelines of a view with these options.
    View(ViewOptions),
}

/// Pipeline sets of a view.
type ViewSets = (Arc<light::Pipelines>, Arc<draw::Pipelines>, Arc<present::Pipelines>);

impl Context {
    /// Compiles the requested pipelines that are not compiled yet, several at once where the platform has threads, and
    /// reports to `progress`. In a browser this is the only way to learn of errors: pipelines that a frame compiles
    /// there are recorded unchecked.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] with wgpu's message for the first pipeline that failed.
    pub async fn prepare(&self, requests: &[PipelineRequest], progress: &impl Progress) -> Result<()> {
        const TASK: &str = "compiling shaders";
        let sets: ViewSets = (self.pipelines(), self.pipelines(), self.pipelines());
        let jobs: Vec<Job<'_>> = requests.iter().flat_map(|request| jobs(self, request, &sets)).collect();
        let fraction = |done: usize| done as f32 / jobs.len().max(1) as f32;
        #[cfg(not(target_arch = "wasm32"))]
        {
            let threads = crate::progress::threads();
            for (i, batch) in jobs.chunks(threads).enumerate() {
                progress.step(TASK, fraction(i * threads)).await;
                run(batch)?;
            }
        }
        // A browser compiles in another process: all pipelines are created before the first result is awaited.
        #[cfg(target_arch = "wasm32")]
        {
            let mut results = Vec::new();
            for job in &jobs {
                let scopes = Scopes::open(&self.device);
                job()?;
                results.push(scopes.close(TASK));
            }
            for (i, result) in results.into_iter().enumerate() {
                progress.step(TASK, fraction(i)).await;
                result.await?;
            }
        }
        progress.step(TASK, 1.0).await;
        Ok(())
    }
}

/// Returns jobs that compile the requested pipelines of `sets`. The sets belong to `context`.
fn jobs<'a>(context: &Context, request: &PipelineRequest, sets: &'a ViewSets) -> Vec<Job<'a>> {
    match *request {
        PipelineRequest::Skinning => context.jobs::<skinning::Pipelines>(),
        PipelineRequest::Roots => {
            let mut jobs = context.jobs::<roots::Pipelines>();
            jobs.extend(context.jobs::<collide::deform::Pipelines>());
            jobs
        }
        PipelineRequest::Volume => context.jobs::<volume::Pipelines>(),
        PipelineRequest::Wind => context.jobs::<wind::Pipelines>(),
        PipelineRequest::Forces => context.jobs::<simulate::Pipelines>(),
        PipelineRequest::Step(vertex_count) => {
            let set = context.pipelines::<simulate::Pipelines>();
            vec![Box::new(move || set.step.of(vertex_count).compile())]
        }
        PipelineRequest::TwistStep(vertex_count) => {
            let set = context.pipelines::<simulate::Pipelines>();
            vec![Box::new(move || set.twist.of(vertex_count).compile())]
        }
        PipelineRequest::Strands => {
            let mut jobs = Curves::jobs(context);
            jobs.extend(context.jobs::<lod::Widths>());
            jobs
        }
        PipelineRequest::Avoid => context.jobs::<avoid::Pipelines>(),
        PipelineRequest::Cards(samples) => sets.1.cards.jobs(samples),
        PipelineRequest::View(options) => {
            let (light, draw, present) = sets;
            let ViewOptions { renderer, output, strand_map_resolution: strand_map, .. } = options;
            let mut jobs = light.jobs(renderer.is_tiles(), strand_map > 0);
            jobs.extend(draw.jobs(renderer));
            // The supersampling factor is not known yet; 1 is the usual one.
            jobs.push(Box::new(move || present.get(renderer, 1, output).map(|_| ())));
            jobs
        }
    }
}

/// Runs all of `jobs` in parallel. Error scopes belong to threads, so jobs open their own.
#[cfg(not(target_arch = "wasm32"))]
fn run(jobs: &[Job<'_>]) -> Result<()> {
    std::thread::scope(|scope| {
        let running: Vec<_> = jobs.iter().map(|job| scope.spawn(job)).collect();
        running.into_iter().try_for_each(|job| {
            // Pass a panic of a job on to the caller.
            job.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    })
}
