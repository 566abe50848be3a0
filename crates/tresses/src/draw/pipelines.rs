//! The pipelines of the stage, each made when it is first needed.

use super::{
    Coverage, soft,
    strips::{self, Strips},
    targets::HDR_FORMAT,
    tiles,
};
use crate::{
    Context, Result,
    body::{self, Body, Painted},
    gpu::{
        Device, PipelineSet,
        kernel::Job,
        pipeline::{Made, Recipe},
    },
    light::{self, ShadingRate},
};

/// The pipelines of the stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    frame: wgpu::BindGroupLayout,
    body: Made<(u32, bool), wgpu::RenderPipeline>,
    pub(super) soft: soft::Pipelines,
    pub(crate) strips: strips::Pipelines,
    pub(crate) tiles: tiles::Pipelines,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let light = &*context.pipelines::<light::Pipelines>();
        Self {
            device: device.clone(),
            frame: light.frame.clone(),
            body: Made::default(),
            soft: soft::Pipelines::new(context, light),
            strips: strips::Pipelines::new(context, light),
            tiles: tiles::Pipelines::new(context),
        }
    }
}

impl Pipelines {
    /// Draws bodies into targets of so many samples per pixel, plain or painted ones.
    pub(super) fn body(&self, samples: u32, painted: bool) -> Result<wgpu::RenderPipeline> {
        self.body.get((samples, painted), || {
            let device = &self.device;
            let own = [&self.frame, &body::layout(device), &soft::points_layout(device)];
            let plain = Recipe {
                vertex: ("draw::body", "body_vertex"),
                fragment: Some(("draw::body", "body_fragment")),
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
                vertex: ("draw::painted", "painted_vertex"),
                fragment: Some(("draw::painted", "painted_fragment")),
                layouts: &[frame, body, points, &body::paint::layout(device)],
                buffers: &[Some(Body::LAYOUT), Some(Painted::LAYOUT)],
                ..plain
            }
            .build(device)
        })
    }

    /// What draws hair with `coverage` into targets of so many samples per pixel.
    pub(super) fn strips(&self, coverage: Coverage, samples: u32, rate: ShadingRate) -> Result<Strips> {
        self.strips.get(coverage, samples, rate)
    }

    /// What makes all that such a picture needs.
    pub(crate) fn jobs(&self, coverage: Coverage, samples: u32, rate: ShadingRate) -> Vec<Job<'_>> {
        let mut jobs: Vec<Job<'_>> = vec![Box::new(move || self.body(samples, false).map(|_| ()))];
        match coverage {
            Coverage::Tiles => jobs.extend(self.tiles.jobs(samples)),
            _ => jobs.extend(self.strips.jobs(coverage, samples, rate)),
        }
        jobs.extend(self.soft.jobs(&self.device));
        jobs
    }
}
