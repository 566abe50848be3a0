//! The shadow maps and the passes that draw them: the body as triangles into depth textures, the
//! hair by kernels into a buffer.
//!
//! Hair is thinner than a texel, so that a line walk with an atomic is all the rasterisation it
//! needs. It reads each vertex once for all maps, has no triangles to set up (a software driver does
//! that on one thread), and keeps hair and body apart: hair lets light through, the body does not.

use glam::Mat4;

use super::{
    lights::{LightsUniform, SHADOW_MAPS},
    shadows::{DEEP_FINEST, ShadowMethod, Shadows},
};
use crate::{
    constants::{DEEP_LAYERS, SHADOW_BLOCK as BLOCK, STRAND_WORKGROUP},
    draw::{Body, HairSet, Scene},
    gpu::{
        Binding, Kernel, Timings,
        bindings::{group, layout},
    },
    shaders,
    strands::StrandBuffers,
};

/// Depth of the shadow maps.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The most texels along an edge: the maps stay within the 128 MiB that any device binds.
const MOST: u32 = 2048;
/// Words of a texel of a deep opacity map, as in `light::deep`.
const DEEP_WORDS: u32 = DEEP_LAYERS + 2;
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
    /// The hair nearest the light.
    splat: Kernel,
    /// The same in blocks of texels.
    summary: Kernel,
    /// Deep opacity maps: where the hair's front is, hair into the layers, sums over the layers.
    deep: [Kernel; 3],
    /// Per map, heights of the hair nearest the light or a deep opacity map.
    hair: wgpu::Buffer,
    /// Per map, how much hair and how high in blocks of texels.
    blocks: wgpu::Buffer,
    comparison: wgpu::Sampler,
    body: wgpu::RenderPipeline,
}

impl ShadowMaps {
    /// Maps of `resolution`² texels. `body` is the layout of [`Body`]'s bind group.
    pub(crate) fn new(device: &wgpu::Device, resolution: u32, body: &wgpu::BindGroupLayout) -> Self {
        let resolution = resolution.clamp(BLOCK, MOST);
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow maps"),
            size: wgpu::Extent3d {
                width: resolution,
                height: resolution,
                depth_or_array_layers: SHADOW_MAPS as u32,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let layers = (0..SHADOW_MAPS as u32)
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
            size: STEP * SHADOW_MAPS as u64,
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
        use Binding::{Storage, StorageMut, Uniform};
        // One group for all: those that need less of it leave the rest alone.
        let kernel = |module| {
            let entries = [Uniform, Uniform, Storage, Storage, StorageMut, StorageMut, Storage];
            Kernel::new(device, module, &entries)
        };
        let buffer = |label, count| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: 4 * SHADOW_MAPS as u64 * count,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let hair =
            buffer("hair in shadow maps", map_words(ShadowMethod::DeepOpacity, resolution, DEEP_FINEST));
        let blocks = buffer("hair blocks", u64::from(resolution.div_ceil(BLOCK)).pow(2));
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
            splat: kernel("light::splat"),
            summary: kernel("light::blocks"),
            deep: ["light::front", "light::cover", "light::stack"].map(kernel),
            hair,
            blocks,
            comparison,
            body,
        }
    }

    /// What shaders need to ask for light: body maps, their sampler, the hair's maps, its blocks.
    pub(crate) fn resources(&self) -> [wgpu::BindingResource<'_>; 4] {
        [
            wgpu::BindingResource::TextureView(&self.view),
            wgpu::BindingResource::Sampler(&self.comparison),
            self.hair.as_entire_binding(),
            self.blocks.as_entire_binding(),
        ]
    }

    /// Bytes of GPU memory.
    pub(crate) fn bytes(&self) -> u64 {
        let depth = 4 * SHADOW_MAPS as u64 * u64::from(self.resolution).pow(2);
        depth + self.hair.size() + self.blocks.size() + self.matrices.size()
    }

    /// The group of all kernels.
    pub(crate) fn bind_splat(
        &self,
        device: &wgpu::Device,
        lights: &wgpu::Buffer,
        uniform: &wgpu::Buffer,
        strands: &StrandBuffers,
    ) -> wgpu::BindGroup {
        let StrandBuffers { vertices, strands, widening, .. } = strands;
        let buffers = [lights, uniform, vertices, strands, &self.hair, &self.blocks, widening];
        self.splat.bind(device, &buffers.map(|buffer| buffer.as_entire_binding()))
    }

    pub(crate) fn prepare(&self, queue: &wgpu::Queue, lights: &LightsUniform) {
        for (i, matrix) in lights.shadow.iter().enumerate() {
            queue.write_buffer(&self.matrices, STEP * i as u64, bytemuck::bytes_of(matrix));
        }
    }

    /// Records the maps of the lights of `scene` that are on, and of the sky where its openness is guessed.
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut timings: Option<&mut Timings>,
        scene: &Scene,
        hair: Option<&HairSet>,
        body: Option<&Body>,
    ) {
        let Shadows { method, .. } = scene.shadows;
        let casts = method != ShadowMethod::Off;
        let (hair, body) = (hair.filter(|_| casts), body.filter(|_| casts));
        let maps = scene.shadows.maps(scene.lights.active().count());
        if maps == 0 {
            return;
        }
        for (i, layer) in self.layers[..maps].iter().enumerate() {
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
        let across = scene.shadows.hair_texels(2.0 * scene.focus.radius.max(1e-6) / self.resolution as f32);
        let words = maps as u64 * map_words(method, self.resolution, across);
        encoder.clear_buffer(&self.hair, 0, Some(4 * words));
        let Some(hair) = hair else {
            encoder.clear_buffer(&self.blocks, 0, None);
            return;
        };
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("shadow"),
            timestamp_writes: timings.and_then(|timings| timings.compute("shadow")),
        });
        let pass = &mut pass;
        let mut run = |kernel: &Kernel, threads: u64| {
            kernel.record(pass, &hair.splat_group, &[], threads.div_ceil(u64::from(STRAND_WORKGROUP)) as u32);
        };
        run(&self.splat, u64::from(hair.drawn.count) * u64::from(hair.splat[1]));
        match method {
            ShadowMethod::DeepOpacity | ShadowMethod::Off => {
                let texels = words / u64::from(DEEP_WORDS);
                let [front, cover, stack] = &self.deep;
                run(front, texels);
                run(
                    cover,
                    u64::from(hair.drawn.count) * u64::from(hair.drawn.vertex_count.saturating_sub(1)),
                );
                run(stack, texels);
            }
            ShadowMethod::Opaque | ShadowMethod::Absorption => {
                run(&self.summary, maps as u64 * u64::from(self.resolution.div_ceil(across * BLOCK)).pow(2));
            }
        }
    }
}

/// Words that the hair takes in one map of `resolution`², whose own texels are `across` of the map's wide.
fn map_words(method: ShadowMethod, resolution: u32, across: u32) -> u64 {
    let words = match method {
        ShadowMethod::Opaque | ShadowMethod::Absorption => 1,
        ShadowMethod::DeepOpacity | ShadowMethod::Off => u64::from(DEEP_WORDS),
    };
    u64::from(resolution.div_ceil(across)).pow(2) * words
}
