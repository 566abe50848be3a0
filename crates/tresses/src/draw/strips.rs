//! Hair as camera-facing strips, drawn by the hardware rasterizer: two vertices per strand vertex, generated in the
//! vertex shader from the shared strand buffer. `masks` and [`super::classic`] draw them.

use super::canvas::{Canvas, pass};
use crate::{
    Context, Result,
    draw::canvas::HDR_FORMAT,
    gpu::{Device, pipeline::Recipe},
    light::{self, HairView},
    stage::Stage,
};
use wgpu::{ColorWrites, CompareFunction};

/// Strand vertices per part when a frame is submitted in parts: about a tenth of a second on a software driver.
const PART: u32 = 1 << 16;

/// Layouts of the bind groups of the frame, the hair and its fiber tables.
#[derive(Debug)]
pub(super) struct StripLayouts {
    pub device: Device,
    pub groups: [wgpu::BindGroupLayout; 3],
}

/// A pass over all strips into the HDR target.
pub(super) struct StripPass<'a> {
    pub module: &'static str,
    /// Vertex and fragment entry points.
    pub entries: [&'a str; 2],
    pub writes: ColorWrites,
    /// Whether depth is written, and its comparison.
    pub depth: (bool, CompareFunction),
    pub samples: u32,
}

impl StripLayouts {
    pub fn new(context: &Context, light: &light::Pipelines) -> Self {
        let groups = [&light.frame, &light.hair, &light.fiber].map(Clone::clone);
        Self { device: context.device.clone(), groups }
    }

    pub fn build(&self, pass: &StripPass<'_>) -> Result<wgpu::RenderPipeline> {
        let [vertex, fragment] = pass.entries;
        Recipe {
            vertex: (pass.module, vertex),
            fragment: Some((pass.module, fragment)),
            layouts: &self.groups.each_ref(),
            targets: &[Some(wgpu::ColorTargetState {
                format: HDR_FORMAT,
                blend: None,
                write_mask: pass.writes,
            })],
            depth: Some(pass.depth),
            samples: pass.samples,
            alpha_to_coverage: pass.writes.is_empty(),
            ..Recipe::PLAIN
        }
        .build(&self.device)
    }
}

/// Records the strips of all grooms in one pass, so that their order does not matter. `clear` clears the targets.
pub(super) fn record(
    pipeline: &wgpu::RenderPipeline,
    canvas: &mut Canvas<'_, '_>,
    hair: &[HairView<'_>],
    clear: bool,
) {
    if !canvas.commands.is_split() {
        let mut pass = pass(canvas, "hair", clear);
        pass.set_pipeline(pipeline);
        return hair.iter().for_each(|view| view.record_strips(&mut pass));
    }
    let mut first = clear;
    for view in hair {
        let drawn = &view.hair.drawn;
        let strands = (PART / drawn.vertex_count.max(1)).max(1);
        for begin in (0..drawn.count).step_by(strands as usize) {
            let mut pass = pass(canvas, "hair", std::mem::take(&mut first));
            pass.set_pipeline(pipeline);
            view.record_strips_of(&mut pass, begin..(begin + strands).min(drawn.count));
            drop(pass);
            canvas.commands.lap(Stage::Hair);
        }
    }
    if first {
        pass(canvas, "hair", true);
    }
}
