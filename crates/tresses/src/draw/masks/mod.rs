//! Hair by sample masks ([`Renderer::Masks`](crate::renderer::Renderer::Masks)).
//!
//! A strip is drawn at least [`min_width`](crate::light::HairMaterial::min_width) pixels wide, so that it meets samples
//! along its whole length. It covers only the fraction `width / drawn width` of the samples. The set of samples is a
//! property of the strand: overlapping strands combine as statistically independent, and there is no noise along a
//! strand. A pixel with few samples also averages its neighbors' samples (`present::footprint`), so that moving hair
//! does not shimmer. With a single sample per pixel the fraction is the probability that the strand is drawn there.

use super::{
    canvas::Canvas,
    strips::{self, StripLayouts, StripPass},
};
use crate::{
    Context, Result,
    gpu::{kernel::Job, pipeline::PipelineCache},
    light::{self, HairView},
};

/// Pipelines by samples per pixel, compiled at first use.
#[derive(Debug)]
pub(crate) struct Pipelines {
    layouts: StripLayouts,
    strips: PipelineCache<u32, wgpu::RenderPipeline>,
}

impl Pipelines {
    pub fn new(context: &Context, light: &light::Pipelines) -> Self {
        Self { layouts: StripLayouts::new(context, light), strips: PipelineCache::default() }
    }

    fn get(&self, samples: u32) -> Result<wgpu::RenderPipeline> {
        self.strips.get(samples, || {
            self.layouts.build(&StripPass {
                module: "draw::masks::masked",
                entries: ["masked_vertex", if samples == 1 { "masked_single" } else { "masked_multi" }],
                writes: wgpu::ColorWrites::ALL,
                depth: (true, wgpu::CompareFunction::Greater),
                samples,
            })
        })
    }

    /// Returns jobs that compile the pipelines. Jobs can run in parallel.
    pub fn jobs(&self, samples: u32) -> Vec<Job<'_>> {
        vec![Box::new(move || self.get(samples).map(|_| ()))]
    }

    /// Records the strips of `hair`. `clear` clears the targets.
    pub fn record(&self, canvas: &mut Canvas<'_, '_>, hair: &[HairView<'_>], clear: bool) -> Result<()> {
        strips::record(&self.get(canvas.target.samples)?, canvas, hair, clear);
        Ok(())
    }
}
