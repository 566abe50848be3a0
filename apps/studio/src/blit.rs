//! Copies a frame to the window. egui's own shader filters and converts color encodings per window pixel in the shader;
//! with a software driver that took as long as drawing the hair.

use eframe::{
    egui::{PaintCallback, PaintCallbackInfo, Rect},
    egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState},
};

const SHADER: &str = "
@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var linear: sampler;
struct Corner { @builtin(position) clip: vec4<f32>, @location(0) at: vec2<f32> }

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let at = vec2(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0), at);
}

@fragment
fn encoded(in: Corner) -> @location(0) vec4<f32> {
    return textureSample(picture, linear, in.at);
}

@fragment
fn decoded(in: Corner) -> @location(0) vec4<f32> {
    let c = textureSample(picture, linear, in.at);
    let high = pow((c.rgb + vec3(0.055)) / 1.055, vec3(2.4));
    return vec4(select(high, c.rgb / 12.92, c.rgb < vec3(0.04045)), c.a);
}
";

/// Pipeline that paints frames on one window.
#[derive(Clone)]
pub struct Blit {
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
}

impl Blit {
    /// Creates the pipeline for the window of `state`.
    pub fn new(state: &RenderState) -> Self {
        let device = &state.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("blit"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let format = state.target_format;
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("blit"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                // An sRGB target encodes its input, so the shader must output linear color.
                entry_point: Some(if format.is_srgb() { "decoded" } else { "encoded" }),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format,
                    blend: None,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            multiview_mask: None,
            cache: None,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("blit"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { pipeline, sampler }
    }

    /// Binds `picture` for painting, in any number of frames.
    pub fn of(&self, device: &wgpu::Device, picture: &wgpu::TextureView) -> DisplayImage {
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blit"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(picture)),
                entry(1, wgpu::BindingResource::Sampler(&self.sampler)),
            ],
        });
        DisplayImage { pipeline: self.pipeline.clone(), group }
    }
}

/// A texture bound for painting.
#[derive(Clone)]
pub struct DisplayImage {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
}

impl DisplayImage {
    /// Returns a callback that paints the texture over `rect`.
    pub fn at(&self, rect: Rect) -> PaintCallback {
        Callback::new_paint_callback(rect, self.clone())
    }
}

impl CallbackTrait for DisplayImage {
    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
