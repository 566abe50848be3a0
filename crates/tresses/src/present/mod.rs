//! From linear radiance to the picture: background, tone mapping, resolve, sRGB.
//!
//! Every sample is composed with the background and tone mapped on its own; their mean is the
//! pixel. Averaging first would let a single bright sample decide a pixel, which sparkles and
//! undoes the antialiasing of a highlight's edge. With twofold supersampling the mean is over the
//! texels that the original's five bilinear samples read (`taps.wesl`), a little wider than the
//! pixel; with more, over the pixel's square. Masks of several samples are averaged over a disc that is
//! wider than the pixel when they are few (`footprint.rs`). A single sample per pixel is blended with its
//! neighbours along the strand or edge that it belongs to, which the structure tensor of its
//! neighbourhood finds. Peeled hair is tone mapped where it is drawn and lies over the rest
//! (`layers.wesl`).

mod footprint;

pub use footprint::Footprint;

use bytemuck::{Pod, Zeroable};
use glam::Vec2;
use wgpu::util::DeviceExt;

use crate::{
    draw::{Background, Coverage, Scene, Targets},
    gpu::{
        Binding, Timings,
        bindings::{group, layout},
    },
    shaders,
};

/// From linear radiance to the picture's 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneMap {
    /// Factor before everything else.
    pub exposure: f32,
    /// Below this the picture is linear; above it is compressed so that it never reaches 1.
    pub shoulder: f32,
    /// How fast colours brighter than the shoulder fade to white.
    pub desaturation: f32,
}

impl Default for ToneMap {
    fn default() -> Self {
        Self { exposure: 1.0, shoulder: 0.7, desaturation: 0.15 }
    }
}

/// What the shaders know of the presentation.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PresentUniform {
    /// What is behind everything.
    pub background: Background,
    /// Width and height of the picture, pixels.
    pub size: Vec2,
    /// [`ToneMap::exposure`].
    pub exposure: f32,
    /// [`ToneMap::shoulder`].
    pub shoulder: f32,
    /// [`ToneMap::desaturation`].
    pub desaturation: f32,
    /// Target pixels per picture pixel, along each axis.
    pub ssaa: u32,
    /// Samples per target pixel.
    pub samples: u32,
    /// 1 when the shader applies the sRGB curve, 0 when the output's format does.
    pub encode: u32,
}

/// The pipeline of the last pass.
#[derive(Debug)]
pub struct Present {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
    /// Of targets with several samples.
    footprint: Option<wgpu::Buffer>,
    encode: bool,
}

impl Present {
    /// For targets of `samples` with hair in them by `coverage`, and an output of `format`.
    pub fn new(device: &wgpu::Device, samples: u32, coverage: Coverage, format: wgpu::TextureFormat) -> Self {
        use Binding::{Depth, Storage, Texture2d, TextureMultisampled};
        let (module, bindings): (_, &[_]) = match (coverage, samples) {
            (Coverage::DepthPeeling { .. }, _) => {
                ("present::layers", &[Storage, Texture2d, Texture2d, Texture2d, Texture2d, Depth])
            }
            (_, 1) => ("present::single", &[Storage, Texture2d]),
            _ => ("present::resolve", &[Storage, TextureMultisampled, Storage]),
        };
        let name = module.rsplit("::").next().unwrap_or(module);
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(module),
            source: wgpu::ShaderSource::Wgsl(shaders::source(module).into()),
        });
        let layout = layout(device, module, wgpu::ShaderStages::FRAGMENT, bindings);
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(module),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(module),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            })),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some(&format!("{name}_vertex")),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some(&format!("{name}_fragment")),
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let uniform = crate::gpu::bindings::uniform(device, "present", size_of::<PresentUniform>());
        let footprint = (samples > 1).then(|| {
            let footprint = match coverage {
                Coverage::SampleMask => Footprint::disc(samples),
                _ => Footprint::square(samples),
            };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("footprint"),
                contents: bytemuck::bytes_of(&footprint),
                usage: wgpu::BufferUsages::STORAGE,
            })
        });
        Self { pipeline, layout, uniform, footprint, encode: !format.is_srgb() }
    }

    pub(crate) fn prepare(&self, queue: &wgpu::Queue, scene: &Scene, targets: &Targets) {
        let uniform = PresentUniform {
            background: scene.background,
            size: Vec2::new(targets.size[0] as f32, targets.size[1] as f32),
            exposure: scene.tone.exposure,
            shoulder: scene.tone.shoulder.clamp(0.0, 0.99),
            desaturation: scene.tone.desaturation,
            ssaa: targets.ssaa,
            samples: targets.samples,
            encode: u32::from(self.encode),
        };
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// Records the pass.
    pub fn record(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) {
        use wgpu::BindingResource::TextureView;
        let mut resources = vec![self.uniform.as_entire_binding(), TextureView(&targets.hdr)];
        resources.extend(self.footprint.iter().map(|footprint| footprint.as_entire_binding()));
        if let Some(layers) = &targets.layers {
            resources.extend(layers.presented().map(TextureView));
            resources.push(TextureView(&targets.depth));
        }
        let group = group(device, "present", &self.layout, &resources);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: output,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            timestamp_writes: timings.and_then(|timings| timings.render("present")),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
