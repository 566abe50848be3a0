//! The renderer of the talk of 2008 ([`Renderer::Classic`]; Tariq and Bavoil, "Real-time hair simulation and rendering
//! on the GPU"), with Kajiya–Kay shading.
//!
//! A frame, from top to bottom:
//!
//! ```text
//! light maps     opaque, absorption or deep opacity maps     light::shadow
//! shading        per vertex: light::shade; per pixel: arrive.wesl stores the light at each vertex
//! alpha to coverage   strips ─► depth of samples made from alpha ─► color where depth is equal
//! depth peeling       body ─► depth ─┬─► layer 1 ─► under ─► layer 2 ─► under ... ─► front ─────────┐
//!                                    └─► hair behind the last layer, weighted by depth ─► rest ────┴─► layers
//! ```
//!
//! A strip is drawn one pixel wider than the strand. The exact fraction of each square pixel that the strand covers
//! becomes alpha (`alpha.wesl`, `draw::coverage`).
//!
//! **Alpha to coverage.** The strand's threshold dithers the rounding of alpha to samples. Depth first: the final pass
//! shades only samples at the depth of the first.
//!
//! **Depth peeling** (`peel.rs`) blends the nearest strands in order, one per layer. One more pass measures the optical
//! thickness of the hair behind the last layer at eight depths (`thickness.wesl`). The last pass weights each of those
//! strands by the transmittance in front of it, and `layers.wesl` composites all over the body.
//!
//! Bodies are drawn before peeled hair, which blends over them, and after other hair, which is cheaper: a body costs
//! more shading per pixel, and hair hides most of the scalp.
//!
//! Rejected: linked lists of fragments (unbounded memory, one atomic per fragment), sorting strands (they cross),
//! moments of transmittance. Untried: peeling several layers per pass.
//!
//! [`Renderer::Classic`]: crate::renderer::Renderer::Classic

mod peel;

pub(crate) use peel::Layers;

use super::{
    canvas::Canvas,
    strips::{self, StripLayouts, StripPass},
};
use crate::{
    Context, Result,
    gpu::{kernel::Job, pipeline::PipelineCache},
    light::{self, HairView},
    renderer::{ClassicCoverage, ClassicOptions, ShadingRate},
};
use peel::Peel;

/// Pipelines of both coverage modes, compiled at first use.
#[derive(Debug)]
pub(crate) struct Pipelines {
    layouts: StripLayouts,
    /// Alpha to coverage: depth, then color.
    alpha: PipelineCache<(u32, ShadingRate, bool), [wgpu::RenderPipeline; 2]>,
    /// Pipelines of depth peeling, by name.
    parts: PipelineCache<(&'static str, ShadingRate, bool), wgpu::RenderPipeline>,
}

/// Returns the vertex entry point of strips that are shaded at `rate`. Names of fragment entry points begin with it.
fn vertex(rate: ShadingRate) -> &'static str {
    match rate {
        ShadingRate::PerVertex => "alpha_shaded",
        ShadingRate::PerPixel => "alpha_raw",
    }
}

/// Returns the shader that shades pixels: for distant lights only, or for all.
fn module(near: bool) -> &'static str {
    if near { "draw::classic::alpha::2" } else { "draw::classic::alpha::0" }
}

impl Pipelines {
    pub fn new(context: &Context, light: &light::Pipelines) -> Self {
        Self {
            layouts: StripLayouts::new(context, light),
            alpha: PipelineCache::default(),
            parts: PipelineCache::default(),
        }
    }

    fn alpha(&self, samples: u32, rate: ShadingRate, near: bool) -> Result<[wgpu::RenderPipeline; 2]> {
        use wgpu::{
            ColorWrites,
            CompareFunction::{Equal, Greater},
        };
        let vertex = vertex(rate);
        let build = |fragment: &str, writes, depth| {
            self.layouts.build(&StripPass {
                module: module(near),
                entries: [vertex, &format!("{vertex}_{fragment}")],
                writes,
                depth,
                samples,
            })
        };
        self.alpha.get((samples, rate, near), || {
            let depth = build("depth", ColorWrites::empty(), (true, Greater))?;
            Ok([depth, build("color", ColorWrites::ALL, (false, Equal))?])
        })
    }

    /// Returns jobs that compile the pipelines of `options`. Jobs can run in parallel.
    pub fn jobs(&self, options: ClassicOptions) -> Vec<Job<'_>> {
        let rate = options.rate;
        match options.coverage {
            ClassicCoverage::AlphaToCoverage { samples } => {
                vec![Box::new(move || self.alpha(samples, rate, false).map(|_| ()))]
            }
            ClassicCoverage::DepthPeeling { .. } => peel::PARTS
                .map(|part| Box::new(move || peel::part(self, part, (rate, false)).map(|_| ())) as Job<'_>)
                .into(),
        }
    }

    /// Records `hair`. `clear` clears the targets; depth peeling clears only its own, since bodies come first.
    pub fn record(
        &self,
        options: ClassicOptions,
        layers: Option<&Layers>,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
        clear: bool,
    ) -> Result<()> {
        let near = canvas.parts.iter().any(|part| part.light.has_near_lights());
        match options.coverage {
            ClassicCoverage::AlphaToCoverage { samples } => {
                let [depth, color] = self.alpha(samples, options.rate, near)?;
                strips::record(&depth, canvas, hair, clear);
                strips::record(&color, canvas, hair, false);
                Ok(())
            }
            ClassicCoverage::DepthPeeling { .. } => {
                Peel::new(self, (options.rate, near))?.record(layers, canvas, hair)
            }
        }
    }
}
