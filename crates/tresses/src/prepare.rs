//! Compiling pipelines in advance.

use crate::{
    Context, Progress, Result, avoid, collide, draw,
    gpu::{kernel::Job, pipeline::Scopes},
    hair::Curves,
    light, lod, present, roots, simulate, skinning,
    view::ViewOptions,
    volume, wind,
};
use std::sync::Arc;

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
        let mut jobs: Vec<Job<'_>> = requests.iter().flat_map(|request| jobs(self, request, &sets)).collect();
        let count = jobs.len().max(1);
        let threads = crate::progress::threads();
        let mut done = 0;
        while !jobs.is_empty() {
            progress.step(TASK, done as f32 / count as f32).await;
            let batch: Vec<_> = jobs.drain(..threads.min(jobs.len())).collect();
            done += batch.len();
            // Error scopes belong to threads, so jobs open their own. In a browser errors arrive later, so one scope
            // spans the batch.
            let scopes = cfg!(target_arch = "wasm32").then(|| Scopes::open(&self.device));
            run(&batch)?;
            if let Some(scopes) = scopes {
                scopes.close(TASK).await?;
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

/// Runs all of `jobs`, in parallel where the platform has threads.
fn run(jobs: &[Job<'_>]) -> Result<()> {
    #[cfg(target_arch = "wasm32")]
    return jobs.iter().try_for_each(|job| job());
    #[cfg(not(target_arch = "wasm32"))]
    std::thread::scope(|scope| {
        let running: Vec<_> = jobs.iter().map(|job| scope.spawn(job)).collect();
        running.into_iter().try_for_each(|job| {
            // Pass a panic of a job on to the caller.
            job.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    })
}
