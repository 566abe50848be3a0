//! Host side of `overdraw.wesl`: strips are drawn into a target that counts them, and the counts become
//! colours.

use super::{Canvas, Paint, overlay};
use crate::{
    Context, Result,
    draw::Coverage,
    gpu::{
        Binding, Device,
        bindings::layout,
        commands::{cleared, deep},
        pipeline::{Made, Recipe, blended},
    },
    light::{self, Seen},
};
use std::sync::Arc;

/// Counts exactly up to 2048, and every adapter blends it.
const COUNTS: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// The two pipelines, counting and showing what was counted, made when they are first asked for.
#[derive(Debug)]
pub(super) struct Overdraw {
    device: Device,
    light: Arc<light::Pipelines>,
    made: Made<&'static str, wgpu::RenderPipeline>,
    layout: wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
}

impl Overdraw {
    pub(super) fn new(context: &Context, format: wgpu::TextureFormat) -> Self {
        let entries = [Binding::Storage, Binding::Texture2d];
        let layout = layout(&context.device, "overdraw", wgpu::ShaderStages::FRAGMENT, &entries);
        Self {
            device: context.device.clone(),
            light: context.pipelines(),
            made: Made::default(),
            layout,
            format,
        }
    }

    /// Counts the strips of each way to cover pixels, which are as wide as it needs them.
    fn count(&self, coverage: Coverage) -> Result<wgpu::RenderPipeline> {
        let vertex = match coverage {
            Coverage::SampleMask => ("draw::hair", "hair_shaded"),
            Coverage::AlphaToCoverage | Coverage::DepthPeeling { .. } | Coverage::Tiles => {
                ("draw::alpha", "alpha_shaded")
            }
        };
        self.made.get(vertex.1, || {
            let light::Pipelines { frame, hair, fiber, .. } = &*self.light;
            Recipe {
                vertex,
                fragment: Some(("views::overdraw", "overdraw_count")),
                layouts: &[frame, hair, fiber],
                targets: &[blended(COUNTS, wgpu::BlendFactor::One, wgpu::BlendFactor::One)],
                depth: Some((false, wgpu::CompareFunction::Greater)),
                ..Recipe::PLAIN
            }
            .build(&self.device)
        })
    }

    /// The strips of `hair` before the body, in colours of their number.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        (frame, coverage): (&wgpu::BindGroup, Coverage),
        hair: &[Seen<'_>],
        paint: &Paint,
    ) -> Result<()> {
        let count = self.count(coverage)?;
        let show = self.made.get("show", || {
            let topology = wgpu::PrimitiveTopology::TriangleList;
            overlay(canvas.device, "views::overdraw", &[&self.layout], self.format, topology, false)
        })?;
        // As large as the picture.
        let size = canvas.depth.texture().size();
        let counts = canvas
            .device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some("overdraw"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: COUNTS,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
            .create_view(&Default::default());
        let mut pass = canvas.commands.render("debug", &[cleared(&counts)], deep(canvas.depth, None));
        pass.set_pipeline(&count);
        pass.set_bind_group(0, frame, &[]);
        hair.iter().for_each(|seen| seen.record_strips(&mut pass));
        drop(pass);
        let paint = canvas.paint(paint);
        let resources = [paint.as_entire_binding(), wgpu::BindingResource::TextureView(&counts)];
        let group = canvas.device.group("overdraw", &self.layout, &resources);
        let mut pass = canvas.pass(false);
        pass.set_pipeline(&show);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    }
}
