//! The shadow maps and the passes that draw them.

use glam::Mat4;

use super::lights::{LightsUniform, SHADOW_LAYERS};
use crate::{
    draw::{Body, HairSet},
    gpu::{
        Binding, Timings,
        bindings::{group, layout},
    },
    shaders,
};

/// Depth of the shadow maps.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Distance between the matrices of two layers: the largest offset alignment WebGPU asks for.
const STEP: u64 = 256;

/// One depth map per light, and the pipelines that draw hair and body into them.
#[derive(Debug)]
pub struct ShadowMaps {
    /// Texels along each edge.
    pub resolution: u32,
    /// All layers.
    pub(crate) view: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    matrices: wgpu::Buffer,
    layer_group: wgpu::BindGroup,
    hair: wgpu::RenderPipeline,
    body: wgpu::RenderPipeline,
}

impl ShadowMaps {
    /// Maps of `resolution`² texels. `hair` and `body` are the layouts of [`HairSet`]'s and
    /// [`Body`]'s bind groups.
    pub(crate) fn new(
        device: &wgpu::Device,
        resolution: u32,
        hair: &wgpu::BindGroupLayout,
        body: &wgpu::BindGroupLayout,
    ) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow maps"),
            size: wgpu::Extent3d {
                width: resolution,
                height: resolution,
                depth_or_array_layers: SHADOW_LAYERS,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let layers = (0..SHADOW_LAYERS)
            .map(|layer| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let matrices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow matrices"),
            size: STEP * u64::from(SHADOW_LAYERS),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layer_layout =
            layout(device, "shadow layer", wgpu::ShaderStages::VERTEX, &[Binding::UniformDynamic]);
        let layer_group = group(
            device,
            "shadow layer",
            &layer_layout,
            &[wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &matrices,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<Mat4>() as u64),
            })],
        );
        let pipeline = |module: &'static str, geometry, topology, buffers: &[Option<_>]| {
            let entry = module.rsplit("::").next();
            let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(module),
                source: wgpu::ShaderSource::Wgsl(shaders::source(module).into()),
            });
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(module),
                layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(module),
                    bind_group_layouts: &[Some(&layer_layout), Some(geometry)],
                    immediate_size: 0,
                })),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: entry,
                    compilation_options: Default::default(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState { topology, ..Default::default() },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Less),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: Default::default(),
                fragment: None,
                multiview_mask: None,
                cache: None,
            })
        };
        let hair = pipeline("light::shadow_hair", hair, wgpu::PrimitiveTopology::LineList, &[]);
        let body = pipeline(
            "light::shadow_body",
            body,
            wgpu::PrimitiveTopology::TriangleList,
            &[Some(Body::LAYOUT)],
        );
        let view = texture.create_view(&Default::default());
        Self { resolution, view, layers, matrices, layer_group, hair, body }
    }

    pub(crate) fn prepare(&self, queue: &wgpu::Queue, lights: &LightsUniform) {
        for (i, matrix) in lights.shadow.iter().enumerate() {
            queue.write_buffer(&self.matrices, STEP * i as u64, bytemuck::bytes_of(matrix));
        }
    }

    /// Records the passes, one per layer.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut timings: Option<&mut Timings>,
        hair: Option<&HairSet>,
        body: Option<&Body>,
    ) {
        for (i, layer) in self.layers.iter().enumerate() {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow"),
                color_attachments: &[],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: layer,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: timings.as_deref_mut().and_then(|timings| timings.render("shadow")),
                ..Default::default()
            });
            pass.set_bind_group(0, &self.layer_group, &[(STEP * i as u64) as u32]);
            if let Some(body) = body {
                pass.set_pipeline(&self.body);
                body.record(&mut pass);
            }
            if let Some(hair) = hair {
                pass.set_pipeline(&self.hair);
                hair.record_lines(&mut pass);
            }
        }
    }
}
