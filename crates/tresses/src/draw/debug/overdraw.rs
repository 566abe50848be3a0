//! Host side of `overdraw.wesl`: strips are drawn into a target that counts them, whose sums become
//! colours.

use super::{Canvas, Paint, depth_state, overlay, pipeline_layout};
use crate::{
    draw::{Coverage, DrawStage, HairSet},
    gpu::{
        Binding,
        bindings::{group, layout},
    },
    shaders,
};

/// Counts exactly up to 2048, and every adapter blends it.
const COUNTS: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// The two pipelines: counting, and showing what was counted.
#[derive(Debug)]
pub(super) struct Overdraw {
    count: wgpu::RenderPipeline,
    show: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    frame: wgpu::BindGroup,
}

impl Overdraw {
    /// For hair as `draw` draws it.
    pub(super) fn new(device: &wgpu::Device, draw: &DrawStage, format: wgpu::TextureFormat) -> Self {
        let (frame, layouts) = draw.hair_groups();
        // The strips of each way to cover pixels are as wide as it needs them.
        let (module, entry) = match draw.coverage() {
            Coverage::SampleMask => ("draw::hair", "hair_shaded"),
            Coverage::AlphaToCoverage | Coverage::DepthPeeling { .. } => ("draw::alpha", "alpha_shaded"),
        };
        let shader = |name: &'static str| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(name),
                source: wgpu::ShaderSource::Wgsl(shaders::source(name).into()),
            })
        };
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let count = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("overdraw"),
            layout: Some(&pipeline_layout(device, &layouts)),
            vertex: wgpu::VertexState {
                module: &shader(module),
                entry_point: Some(entry),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(depth_state(false)),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader("draw::debug::overdraw"),
                entry_point: Some("overdraw_count"),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: COUNTS,
                    blend: Some(wgpu::BlendState { color: add, alpha: add }),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        let layout =
            layout(device, "overdraw", wgpu::ShaderStages::FRAGMENT, &[Binding::Uniform, Binding::Texture2d]);
        let topology = wgpu::PrimitiveTopology::TriangleList;
        let show = overlay(device, "draw::debug::overdraw", &[&layout], format, topology, false);
        Self { count, show, layout, frame: frame.clone() }
    }

    /// The strips of `hair` before the body, in colours of their number.
    pub(super) fn record(&self, canvas: &mut Canvas<'_>, hair: &HairSet, paint: &Paint) {
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
        let mut pass = canvas.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("overdraw"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &counts,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: canvas.depth,
                depth_ops: None,
                stencil_ops: None,
            }),
            timestamp_writes: canvas.timings.as_deref_mut().and_then(|timings| timings.render("debug")),
            ..Default::default()
        });
        pass.set_pipeline(&self.count);
        pass.set_bind_group(0, &self.frame, &[]);
        hair.record_strips(&mut pass);
        drop(pass);
        let paint = canvas.paint(paint);
        let resources = [paint.as_entire_binding(), wgpu::BindingResource::TextureView(&counts)];
        let group = group(canvas.device, "overdraw", &self.layout, &resources);
        let mut pass = canvas.pass(false);
        pass.set_pipeline(&self.show);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
