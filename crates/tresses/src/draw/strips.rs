//! The pipelines of hair, one set for each way to cover pixels.

use super::{
    Coverage, DrawOptions,
    peel::Peel,
    pipeline::{Recipe, hdr},
};
use crate::light::ShadingRate;

/// One pipeline for each place where hair can be shaded.
#[derive(Debug)]
pub(crate) struct ByRate {
    per_vertex: wgpu::RenderPipeline,
    per_pixel: wgpu::RenderPipeline,
}

impl ByRate {
    /// `build` gets what the names of entry points begin with.
    pub fn new(build: impl Fn(&str) -> wgpu::RenderPipeline) -> Self {
        Self { per_vertex: build("shaded"), per_pixel: build("raw") }
    }

    pub fn of(&self, rate: ShadingRate) -> &wgpu::RenderPipeline {
        match rate {
            ShadingRate::PerVertex => &self.per_vertex,
            ShadingRate::PerPixel => &self.per_pixel,
        }
    }
}

/// What hair is drawn with.
#[derive(Debug)]
pub(crate) enum Strips {
    /// One pass.
    Once(ByRate),
    /// Depth first, then the colour of what is nearest.
    DepthFirst { depth: ByRate, color: ByRate },
    /// One pass per layer.
    Peeled(Peel),
}

impl Strips {
    /// For the bind groups of the frame, of the hair and of its fibre's tables.
    pub fn new(device: &wgpu::Device, options: &DrawOptions, groups: [&wgpu::BindGroupLayout; 3]) -> Self {
        use wgpu::{
            ColorWrites,
            CompareFunction::{Equal, Greater},
        };
        let recipe = Recipe {
            module: "draw::hair",
            entry: ["", ""],
            layouts: &groups.map(Some),
            buffers: &[],
            targets: &[hdr(ColorWrites::ALL)],
            depth: Some((true, Greater)),
            samples: options.samples,
            alpha_to_coverage: false,
        };
        match options.coverage {
            Coverage::SampleMask => {
                let kind = if options.samples == 1 { "single" } else { "multi" };
                Self::Once(ByRate::new(|rate| {
                    let [vertex, fragment] = [format!("hair_{rate}"), format!("hair_{rate}_{kind}")];
                    Recipe { entry: [&vertex, &fragment], ..recipe }.build(device)
                }))
            }
            Coverage::AlphaToCoverage => {
                let pass = |kind: &str, writes: ColorWrites, depth| {
                    ByRate::new(|rate| {
                        let [vertex, fragment] = [format!("alpha_{rate}"), format!("alpha_{rate}_{kind}")];
                        Recipe {
                            module: "draw::alpha",
                            entry: [&vertex, &fragment],
                            targets: &[hdr(writes)],
                            depth: Some(depth),
                            alpha_to_coverage: writes.is_empty(),
                            ..recipe
                        }
                        .build(device)
                    })
                };
                Self::DepthFirst {
                    depth: pass("depth", ColorWrites::empty(), (true, Greater)),
                    color: pass("color", ColorWrites::ALL, (false, Equal)),
                }
            }
            Coverage::DepthPeeling { .. } => {
                Self::Peeled(Peel::new(device, options.coverage.layers(), groups))
            }
        }
    }
}
