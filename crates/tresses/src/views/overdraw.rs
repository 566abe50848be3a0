//! Host side of `overdraw.wesl`: draws strips into a target that counts them, then shows the counts as colors.

use super::{Canvas, Paint, overlay};
use crate::{
    Context, Result,
    gpu::{
        Binding, Device,
        bindings::layout,
        commands::{cleared, deep},
        pipeline::{PipelineCache, Recipe, blended},
    },
    light::{self, HairView},
    renderer::Renderer,
};
use std::sync::Arc;

/// A format that counts exactly up to 2048, and that every adapter can blend.
const COUNTS: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// The pipelines that count and that show the counts, created on first use.
#[derive(Debug)]
pub(super) struct Overdraw {
    device: Device,
    light: Arc<light::Pipelines>,
    cache: PipelineCache<&'static str, wgpu::RenderPipeline>,
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
            cache: PipelineCache::default(),
            layout,
            format,
        }
    }

    /// Returns the counting pipeline of a renderer, which sets the width of the strips.
    fn count(&self, renderer: Renderer) -> Result<wgpu::RenderPipeline> {
        let vertex = match renderer {
            Renderer::Masks(_) => ("draw::masks::masked", "masked_vertex"),
            Renderer::Tiles(_) | Renderer::Classic(_) => ("views::overdraw", "overdraw_strip"),
        };
        self.cache.get(vertex.1, || {
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

    /// Records the number of strips of `hair` in front of meshes, as colors.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        (frame, renderer): (&wgpu::BindGroup, Renderer),
        hair: &[HairView<'_>],
        paint: &Paint,
    ) -> Result<()> {
        let count = self.count(renderer)?;
        let show = self.cache.get("show", || {
            let topology = wgpu::PrimitiveTopology::TriangleList;
            overlay(canvas.device, "views::overdraw", &[&self.layout], self.format, topology, false)
        })?;
        // The size of the frame.
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
        hair.iter().for_each(|view| view.record_strips(&mut pass));
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
