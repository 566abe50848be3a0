//! The HDR target of a view and the inputs of its passes, shared by the draw stages.

use crate::{
    Camera,
    body::Body,
    gpu::{
        Commands, Device, RenderPass, Uniform,
        commands::{colored, deep},
    },
    light::{self, Part, Sphere},
    renderer::Renderer,
    space::Space,
};

/// Label, format and usage of a texture of the HDR target's size.
pub(crate) type TextureKind = (&'static str, wgpu::TextureFormat, wgpu::TextureUsages);

/// Format of the linear HDR target.
pub const HDR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of its depth buffer.
pub use crate::gpu::pipeline::DEPTH_FORMAT;

/// The HDR target of one image size.
#[derive(Debug)]
pub(crate) struct HdrTarget {
    pub device: Device,
    /// Width and height of the image, pixels.
    pub size: [u32; 2],
    /// Samples per pixel of the target.
    pub samples: u32,
    /// Pixels of the target per pixel of the image, along each axis.
    pub ssaa: u32,
    pub color: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    pub depth_texture: wgpu::Texture,
}

impl HdrTarget {
    /// Returns a function that creates textures of the target's size with one sample per pixel.
    pub fn texture(&self) -> impl Fn(TextureKind) -> wgpu::Texture {
        let size = self.depth_texture.size();
        move |(label, format, usage)| {
            self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        }
    }
}

/// Inputs of the draw passes of one view.
pub(crate) struct Canvas<'a, 'c> {
    pub commands: &'a mut Commands<'c>,
    pub target: &'a HdrTarget,
    /// Bind group 0 of the view.
    pub frame: &'a wgpu::BindGroup,
    /// Camera uniform of the view.
    pub eye: &'a Uniform,
    /// Light state of the view.
    pub light: &'a light::LightState,
    /// Grooms and bodies of each light zone; a single part without zones.
    pub parts: &'a [Part<'a>],
    pub camera: &'a Camera,
    /// Focus of the view. Sets the spacing of the shading points on bodies (`draw::soft`).
    pub focus: &'a Sphere,
    pub renderer: Renderer,
    /// Coefficients of the map from the view's depth to the scene's, if hair geometry is requested (`tiles::geometry`).
    pub geometry: Option<[f32; 4]>,
    /// Whether per-pixel strand labels are requested.
    pub writes_labels: bool,
    /// Space of all drawn positions.
    pub space: Space,
}

impl Canvas<'_, '_> {
    /// Largest acceptable simplification error of `body`, meters: half a pixel at its nearest point. With a third of a
    /// pixel, 60 to 160 pixels of a portrait, at lips and outlines, change by more than 24 of 255. A software driver
    /// then takes a quarter more time, since it shades blocks of 4×4 pixels and the triangles are smaller.
    pub fn stray(&self, body: &Body) -> f32 {
        const PIXELS: f32 = 0.5;
        PIXELS * body.nearest(self.camera) * self.camera.pixel() / self.target.ssaa as f32
    }
}

/// Calls `record` for each body index, with the light of the body's zone bound as group 0.
pub(super) fn record_parts(
    pass: &mut RenderPass<'_>,
    parts: &[Part<'_>],
    mut record: impl FnMut(&mut RenderPass<'_>, usize),
) {
    for part in parts {
        if part.number > 0 && !part.bodies.is_empty() {
            pass.set_bind_group(0, &part.light.frame, &[]);
        }
        part.bodies.iter().for_each(|i| record(pass, *i));
    }
}

/// Begins a pass into the HDR target with the view's bind group set.
pub(crate) fn pass<'e>(canvas: &'e mut Canvas<'_, '_>, name: &'static str, clear: bool) -> RenderPass<'e> {
    let color = if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
    let depth = if clear { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
    let depth = wgpu::Operations { load: depth, store: wgpu::StoreOp::Store };
    let target = canvas.target;
    let (color, depth) = (colored(&target.color, color), deep(&target.depth, Some(depth)));
    let mut pass = canvas.commands.render(name, &[color], depth);
    pass.set_bind_group(0, canvas.frame, &[]);
    pass
}
