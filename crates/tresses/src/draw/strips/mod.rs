//! Hair as camera-facing strips, drawn by the hardware rasterizer. Each coverage mode has its own pipelines.
//!
//! The rest of `draw` uses [`Pipelines`], [`Layers`] (the targets of depth peeling), [`body_first`] and [`record`].

mod peel;

pub(crate) use peel::Layers;

use super::{
    Coverage, Targets,
    record::{Canvas, pass},
    targets::HDR_FORMAT,
};
use crate::{
    Context, Result,
    gpu::{
        Device,
        kernel::Job,
        pipeline::{PipelineCache, Recipe},
    },
    light::{self, HairView, ShadingRate},
    stage::Stage,
};
use peel::Peel;

/// Strand vertices per part when a frame is submitted in parts: about a tenth of a second on a software driver.
const PART: u32 = 1 << 16;

/// Pipelines of one coverage mode.
#[derive(Clone, Debug)]
pub(crate) enum Strips {
    /// One pass.
    Once(wgpu::RenderPipeline),
    /// Depth first, then the color of the nearest strip.
    DepthFirst { depth: wgpu::RenderPipeline, color: wgpu::RenderPipeline },
    /// One pass per layer.
    Peeled(Peel),
}

/// All strip pipelines, compiled at first use.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    /// Layouts of the bind groups of the frame, the hair and its fiber tables.
    groups: [wgpu::BindGroupLayout; 3],
    strips: PipelineCache<(Kind, u32, ShadingRate), Strips>,
    /// Pipelines of depth peeling, by name.
    parts: PipelineCache<(&'static str, ShadingRate), wgpu::RenderPipeline>,
}

/// Coverage modes with their own pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Kind {
    Mask,
    Alpha,
    Peel,
}

impl Kind {
    fn of(coverage: Coverage) -> Result<Self> {
        match coverage {
            Coverage::SampleMask => Ok(Self::Mask),
            Coverage::AlphaToCoverage => Ok(Self::Alpha),
            Coverage::DepthPeeling { .. } => Ok(Self::Peel),
            Coverage::Tiles => Err(crate::Error::Parameter {
                name: "the coverage of strips",
                value: "tiles".into(),
                range: "sample mask, alpha to coverage or depth peeling",
            }),
        }
    }
}

/// Returns the name of `rate` in entry points.
fn named(rate: ShadingRate) -> &'static str {
    match rate {
        ShadingRate::PerVertex => "shaded",
        ShadingRate::PerPixel => "raw",
    }
}

impl Pipelines {
    pub fn new(context: &Context, light: &light::Pipelines) -> Self {
        let Context { device, .. } = context;
        let groups = [&light.frame, &light.hair, &light.fiber].map(Clone::clone);
        Self {
            device: device.clone(),
            groups,
            strips: PipelineCache::default(),
            parts: PipelineCache::default(),
        }
    }

    /// Returns the pipelines for `coverage` and targets with `samples` per pixel.
    pub fn get(&self, coverage: Coverage, samples: u32, rate: ShadingRate) -> Result<Strips> {
        let kind = Kind::of(coverage)?;
        self.strips.get((kind, samples, rate), || self.make(kind, samples, rate))
    }

    fn make(&self, kind: Kind, samples: u32, rate: ShadingRate) -> Result<Strips> {
        use wgpu::{
            ColorWrites,
            CompareFunction::{Equal, Greater},
        };
        let name = named(rate);
        let strips = |module, kind: &str, writes: ColorWrites, depth| {
            let start = if module == "draw::hair" { "hair" } else { "alpha" };
            Recipe {
                vertex: (module, &format!("{start}_{name}")),
                fragment: Some((module, &format!("{start}_{name}_{kind}"))),
                layouts: &self.groups.each_ref(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: HDR_FORMAT,
                    blend: None,
                    write_mask: writes,
                })],
                depth: Some(depth),
                samples,
                alpha_to_coverage: writes.is_empty(),
                ..Recipe::PLAIN
            }
            .build(&self.device)
        };
        Ok(match kind {
            Kind::Mask => {
                let entry = if samples == 1 { "single" } else { "multi" };
                Strips::Once(strips("draw::hair", entry, ColorWrites::ALL, (true, Greater))?)
            }
            Kind::Alpha => Strips::DepthFirst {
                depth: strips("draw::alpha", "depth", ColorWrites::empty(), (true, Greater))?,
                color: strips("draw::alpha", "color", ColorWrites::ALL, (false, Equal))?,
            },
            Kind::Peel => Strips::Peeled(Peel::new(self, rate)?),
        })
    }

    /// Returns jobs that compile the pipelines of one coverage mode. Jobs can run in parallel.
    pub fn jobs(&self, coverage: Coverage, samples: u32, rate: ShadingRate) -> Vec<Job<'_>> {
        match coverage {
            Coverage::DepthPeeling { .. } => peel::PARTS
                .map(|part| Box::new(move || peel::part(self, part, rate).map(|_| ())) as Job<'_>)
                .into(),
            _ => vec![Box::new(move || self.get(coverage, samples, rate).map(|_| ()))],
        }
    }
}

/// Whether bodies are drawn before the hair, as blended hair requires. Otherwise they are drawn after it, which is
/// cheaper: a body costs more shading per pixel, and hair hides most of the scalp.
pub(crate) fn body_first(coverage: Coverage) -> bool {
    matches!(coverage, Coverage::DepthPeeling { .. })
}

/// Records the strips of `hair`. Each pass draws all grooms, so their order does not matter. `clear` clears the
/// targets; depth peeling clears only its own targets, since bodies [come first](body_first).
pub(crate) fn record(
    strips: &Strips,
    canvas: &mut Canvas<'_, '_>,
    hair: &[HairView<'_>],
    clear: bool,
) -> Result<()> {
    let apart = canvas.commands.takes_apart();
    let mut once = |pipeline: &wgpu::RenderPipeline, clear| {
        if !apart {
            let mut pass = pass(canvas, "hair", clear);
            pass.set_pipeline(pipeline);
            return hair.iter().for_each(|seen| seen.record_strips(&mut pass));
        }
        let mut first = clear;
        for seen in hair {
            let drawn = &seen.hair.drawn;
            let strands = (PART / drawn.vertex_count.max(1)).max(1);
            for begin in (0..drawn.count).step_by(strands as usize) {
                let mut pass = pass(canvas, "hair", std::mem::take(&mut first));
                pass.set_pipeline(pipeline);
                seen.record_strips_of(&mut pass, begin..(begin + strands).min(drawn.count));
                drop(pass);
                canvas.commands.lap(Stage::Hair);
            }
        }
        if first {
            pass(canvas, "hair", true);
        }
    };
    match strips {
        Strips::Once(all) => once(all, clear),
        Strips::DepthFirst { depth, color } => {
            once(depth, clear);
            once(color, false);
        }
        Strips::Peeled(peel) => peel.record(canvas, hair)?,
    }
    Ok(())
}

/// Returns the layers of targets that were made for depth peeling.
fn layers(targets: &Targets) -> Result<&Layers> {
    targets.layers.as_ref().ok_or_else(|| crate::Error::Parameter {
        name: "targets",
        value: "without layers".into(),
        range: "made for depth peeling",
    })
}
