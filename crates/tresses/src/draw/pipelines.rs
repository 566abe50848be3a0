//! Pipelines of the draw stage, each compiled at first use.

use super::{canvas::HDR_FORMAT, cards, classic, masks, soft, tiles};
use crate::{
    Context, Result,
    body::{self, Body, BodyTextures},
    gpu::{
        Device, PipelineSet,
        kernel::Job,
        pipeline::{PipelineCache, Recipe},
    },
    light,
    renderer::Renderer,
};

/// Pipelines of the draw stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    frame: wgpu::BindGroupLayout,
    body: PipelineCache<(u32, bool, bool), wgpu::RenderPipeline>,
    pub(super) soft: soft::Pipelines,
    pub(crate) cards: cards::Pipelines,
    pub(super) masks: masks::Pipelines,
    pub(super) classic: classic::Pipelines,
    pub(crate) tiles: tiles::Pipelines,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let light = &*context.pipelines::<light::Pipelines>();
        Self {
            device: device.clone(),
            frame: light.frame.clone(),
            body: PipelineCache::default(),
            soft: soft::Pipelines::new(context, light),
            cards: cards::Pipelines::new(context, light),
            masks: masks::Pipelines::new(context, light),
            classic: classic::Pipelines::new(context, light),
            tiles: tiles::Pipelines::new(context),
        }
    }
}

impl Pipelines {
    /// Returns the pipeline that draws bodies into targets with `samples` per pixel. `painted` selects textured bodies,
    /// `near` frames with lights that are not distant.
    pub(super) fn body(&self, samples: u32, painted: bool, near: bool) -> Result<wgpu::RenderPipeline> {
        let (module, painted_module) = match near {
            false => ("draw::body::0", "draw::painted::0"),
            true => ("draw::body::2", "draw::painted::2"),
        };
        self.body.get((samples, painted, near), || {
            let device = &self.device;
            let own = [&self.frame, &body::layout(device), &soft::points_layout(device)];
            let plain = Recipe {
                vertex: (module, "body_vertex"),
                fragment: Some((module, "body_fragment")),
                layouts: &own,
                buffers: &[Some(Body::LAYOUT)],
                targets: &[Some(HDR_FORMAT.into())],
                depth: Some((true, wgpu::CompareFunction::Greater)),
                samples,
                ..Recipe::PLAIN
            };
            if !painted {
                return plain.build(device);
            }
            let [frame, body, points] = own;
            Recipe {
                vertex: (painted_module, "painted_vertex"),
                fragment: Some((painted_module, "painted_fragment")),
                layouts: &[frame, body, points, &body::paint::layout(device)],
                buffers: &[Some(Body::LAYOUT), Some(BodyTextures::LAYOUT)],
                ..plain
            }
            .build(device)
        })
    }

    /// Returns jobs that compile the pipelines of a view with this renderer.
    pub(crate) fn jobs(&self, renderer: Renderer) -> Vec<Job<'_>> {
        let samples = renderer.samples();
        let mut jobs: Vec<Job<'_>> = vec![Box::new(move || self.body(samples, false, false).map(|_| ()))];
        jobs.extend(match renderer {
            Renderer::Tiles(_) => self.tiles.jobs(samples),
            Renderer::Masks(_) => self.masks.jobs(samples),
            Renderer::Classic(options) => self.classic.jobs(options),
        });
        jobs.extend(self.soft.jobs(&self.device));
        jobs
    }
}
