//! Hair as camera-facing strips, by the hardware's rasteriser: one set of pipelines for each way to cover pixels.
//!
//! To the rest of `draw` this folder is four things: [`Pipelines`], [`Layers`] (the textures that peeling adds to
//! the targets), [`body_first`] and [`record`]. A second rasteriser is a folder like it.

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
        pipeline::{Made, Recipe},
    },
    light::{self, Seen, ShadingRate},
    stage::Stage,
};
use peel::Peel;

/// Vertices of the strands that are a part of their own where a frame is taken apart: what a software driver draws
/// in about a tenth of a second.
const PART: u32 = 1 << 16;

/// What hair is drawn with.
#[derive(Clone, Debug)]
pub(crate) enum Strips {
    /// One pass.
    Once(wgpu::RenderPipeline),
    /// Depth first, then the colour of what is nearest.
    DepthFirst { depth: wgpu::RenderPipeline, color: wgpu::RenderPipeline },
    /// One pass per layer.
    Peeled(Peel),
}

/// The pipelines.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    /// Of the frame, of the hair and of its fibres' tables.
    groups: [wgpu::BindGroupLayout; 3],
    strips: Made<(Kind, u32, ShadingRate), Strips>,
    /// Parts of which several sets are made.
    parts: Made<(&'static str, ShadingRate), wgpu::RenderPipeline>,
}

/// Ways to cover pixels that need pipelines of their own.
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
                range: "a mask, alpha to coverage or depth peeling",
            }),
        }
    }
}

/// What the names of entry points call it.
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
        Self { device: device.clone(), groups, strips: Made::default(), parts: Made::default() }
    }

    /// Those for `coverage` and targets of so many samples per pixel.
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

    /// What makes those of a picture, several at once where there are several.
    pub fn jobs(&self, coverage: Coverage, samples: u32, rate: ShadingRate) -> Vec<Job<'_>> {
        match coverage {
            Coverage::DepthPeeling { .. } => peel::PARTS
                .map(|part| Box::new(move || peel::part(self, part, rate).map(|_| ())) as Job<'_>)
                .into(),
            _ => vec![Box::new(move || self.get(coverage, samples, rate).map(|_| ()))],
        }
    }
}

/// Whether bodies are to be drawn before the hair: when this is blended. Else after it: a
/// body's shading costs more per pixel, and most of the scalp is hidden.
pub(crate) fn body_first(coverage: Coverage) -> bool {
    matches!(coverage, Coverage::DepthPeeling { .. })
}

/// Records `hair`, all grooms in every pass, so that none is before another. Clears the targets if `clear`; of
/// peeled hair only its own, since bodies [come first](body_first).
pub(crate) fn record(
    strips: &Strips,
    canvas: &mut Canvas<'_, '_>,
    hair: &[Seen<'_>],
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

/// The layers of peeled hair in targets, which a view that peels has made.
fn layers(targets: &Targets) -> Result<&Layers> {
    targets.layers.as_ref().ok_or_else(|| crate::Error::Parameter {
        name: "targets",
        value: "without layers".into(),
        range: "made for depth peeling",
    })
}
