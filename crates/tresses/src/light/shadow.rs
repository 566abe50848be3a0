//! The shadow maps and the passes that draw them: the body as triangles into depth textures, the
//! hair by a kernel into a buffer.
//!
//! Hair is thinner than a texel, so that a line walk with an atomic maximum is all the
//! rasterisation it needs. It reads each vertex once for all maps, has no triangles to set up (a
//! software driver does that on one thread), and keeps hair and body apart: hair lets light
//! through, the body does not.

use glam::Mat4;

use super::lights::{LightsUniform, SHADOW_LAYERS};
use crate::{
    constants::STRAND_WORKGROUP,
    draw::{Body, HairSet},
    gpu::{
        Binding, Kernel, Timings,
        bindings::{group, layout},
    },
    shaders,
    strands::StrandBuffers,
};

/// Depth of the shadow maps.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Edge of a block of texels, as in `light::lights`.
const BLOCK: u32 = 8;
/// Distance between the matrices of two layers: the largest offset alignment WebGPU asks for.
const STEP: u64 = 256;

/// One depth map per light, and the pipelines that draw hair and body into them.
#[derive(Debug)]
pub struct ShadowMaps {
    /// Texels along each edge.
    pub resolution: u32,
    /// Depth of the body, all layers.
    view: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    matrices: wgpu::Buffer,
    layer_group: wgpu::BindGroup,
    splat: Kernel,
    /// Height of the hair nearest the light, one per texel and layer.
    nearest: wgpu::Buffer,
    /// The same in blocks of texels: how much hair, and how high.
    blocks: wgpu::Buffer,
    block_kernel: Kernel,
    comparison: wgpu::Sampler,
    body: wgpu::RenderPipeline,
}

impl ShadowMaps {
    /// Maps of `resolution`² texels. `body` is the layout of [`Body`]'s bind group.
    pub(crate) fn new(device: &wgpu::Device, resolution: u32, body: &wgpu::BindGroupLayout) -> Self {
        let resolution = resolution.clamp(BLOCK, 8192).next_multiple_of(BLOCK);
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
        let module = "light::shadow_body";
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(module),
            source: wgpu::ShaderSource::Wgsl(shaders::source(module).into()),
        });
        let body = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(module),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(module),
                bind_group_layouts: &[Some(&layer_layout), Some(body)],
                immediate_size: 0,
            })),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("shadow_body"),
                compilation_options: Default::default(),
                buffers: &[Some(Body::LAYOUT)],
            },
            primitive: Default::default(),
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
        });
        let splat = Kernel::new(
            device,
            "light::splat",
            &[Binding::Uniform, Binding::Uniform, Binding::Storage, Binding::StorageMut, Binding::Storage],
        );
        let texels = u64::from(SHADOW_LAYERS) * u64::from(resolution) * u64::from(resolution);
        let buffer = |label, count| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: 4 * count,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let nearest = buffer("nearest hair", texels);
        let blocks = buffer("hair blocks", texels / u64::from(BLOCK * BLOCK));
        let block_kernel =
            Kernel::new(device, "light::blocks", &[Binding::Uniform, Binding::Storage, Binding::StorageMut]);
        let comparison = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow comparison"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let view = texture.create_view(&Default::default());
        Self {
            resolution,
            view,
            layers,
            matrices,
            layer_group,
            splat,
            nearest,
            blocks,
            block_kernel,
            comparison,
            body,
        }
    }

    /// What shaders need to ask for light: body maps, their sampler, nearest hair, its blocks.
    pub(crate) fn resources(&self) -> [wgpu::BindingResource<'_>; 4] {
        [
            wgpu::BindingResource::TextureView(&self.view),
            wgpu::BindingResource::Sampler(&self.comparison),
            self.nearest.as_entire_binding(),
            self.blocks.as_entire_binding(),
        ]
    }

    /// The group of the pass that sums up blocks.
    pub(crate) fn bind_blocks(&self, device: &wgpu::Device, lights: &wgpu::Buffer) -> wgpu::BindGroup {
        let buffers = [lights, &self.nearest, &self.blocks];
        self.block_kernel.bind(device, &buffers.map(|buffer| buffer.as_entire_binding()))
    }

    pub(crate) fn bind_splat(
        &self,
        device: &wgpu::Device,
        lights: &wgpu::Buffer,
        uniform: &wgpu::Buffer,
        strands: &StrandBuffers,
    ) -> wgpu::BindGroup {
        let buffers = [lights, uniform, &strands.vertices, &self.nearest, &strands.widening];
        self.splat.bind(device, &buffers.map(|buffer| buffer.as_entire_binding()))
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
        }
        encoder.clear_buffer(&self.nearest, 0, None);
        if hair.is_none() {
            encoder.clear_buffer(&self.blocks, 0, None);
        }
        if let Some(hair) = hair {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("shadow"),
                timestamp_writes: timings.and_then(|timings| timings.compute("shadow")),
            });
            let workgroups = (hair.count * hair.splat[1]).div_ceil(STRAND_WORKGROUP);
            self.splat.record(&mut pass, &hair.splat_group, &[], workgroups);
            let blocks = (self.blocks.size() / 4) as u32;
            self.block_kernel.record(&mut pass, &hair.block_group, &[], blocks.div_ceil(STRAND_WORKGROUP));
        }
    }
}
