//! From linear radiance to the image: resolve, background, tone mapping, sRGB.
//!
//! All samples of a pixel are averaged in linear light, premultiplied. The mean is composited over the background and
//! tone mapped once, as a camera does. Tone mapping each sample would dull bright strands: the brightest tenth of blond
//! hair would have 0.88 to 0.91 of the path tracer's light instead of 0.99 to 1.00 (Sintel's groom, TressFX's). Bright
//! samples are not clamped: images change no more from frame to frame without a clamp. A clamp at three times white
//! changes almost nothing, and one at 1.5 times white removes 7 to 13 % of blond hair's light.
//!
//! How a pixel is averaged depends on the targets:
//! - Twofold supersampling uses a filter of twelve texels, a little wider than the pixel (`taps.wesl`); more
//!   supersampling uses the pixel's square.
//! - Sample masks are averaged over a disc that is wider than the pixel if it has few samples (`footprint.rs`).
//! - A single sample per pixel is blended with its neighbors along the strand or edge that the structure tensor of its
//!   neighborhood finds (`smooth.wesl`).
//! - Peeled hair is composited over the rest (`draw/classic/layers.wesl`), hair of tiles over each of the two surfaces
//!   of a pixel
//!   (`tiled.wesl`).

mod background;
mod footprint;

pub use background::Background;
pub(crate) use footprint::Footprint;

use bytemuck::{Pod, Zeroable};
use glam::Vec2;
use wgpu::util::DeviceExt;

use crate::{
    Context, Result,
    camera::ToneMap,
    draw::Targets,
    gpu::{
        Binding, Commands, Device, PipelineSet, Uniform,
        bindings::layout,
        commands::cleared,
        pipeline::{PipelineCache, Recipe},
    },
    renderer::Renderer,
};
use std::sync::Arc;

/// Uniform of the present pass.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct PresentUniform {
    /// The background.
    pub background: Background,
    /// Width and height of the image, pixels.
    pub size: Vec2,
    /// [`ToneMap::exposure`].
    pub exposure: f32,
    /// [`ToneMap::shoulder`].
    pub shoulder: f32,
    /// [`ToneMap::desaturation`].
    pub desaturation: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// Pipelines of the present stage, each compiled at first use.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    /// Keyed by shader, whether targets are supersampled, and output format.
    cache: PipelineCache<(&'static str, bool, wgpu::TextureFormat), wgpu::RenderPipeline>,
}

/// Returns the shader for the targets of `renderer`, and its bindings.
fn shader(renderer: Renderer) -> (&'static str, &'static [Binding]) {
    use Binding::{Depth, DepthMultisampled, Storage, Texture2d, TextureMultisampled, Uniform};
    match (renderer, renderer.samples()) {
        _ if renderer.layers().is_some() => {
            ("draw::classic::layers", &[Uniform, Texture2d, Texture2d, Texture2d, Texture2d, Depth])
        }
        (Renderer::Tiles(_), 1) => ("present::tiled_one", &[Uniform, Texture2d, Texture2d]),
        (Renderer::Tiles(_), _) => {
            ("present::tiled", &[Uniform, TextureMultisampled, DepthMultisampled, Texture2d, Storage])
        }
        (_, 1) => ("present::single", &[Uniform, Texture2d]),
        _ => ("present::resolve", &[Uniform, TextureMultisampled, Storage]),
    }
}

/// Returns the number of steps of `format` between black and white; 0 for floating-point formats.
fn steps(format: wgpu::TextureFormat) -> f64 {
    use wgpu::TextureFormat::{
        Bgra8Unorm, Bgra8UnormSrgb, Rgb10a2Unorm, Rgba8Unorm, Rgba8UnormSrgb, Rgba16Unorm,
    };
    match format {
        Rgba8Unorm | Rgba8UnormSrgb | Bgra8Unorm | Bgra8UnormSrgb => 255.0,
        Rgb10a2Unorm => 1023.0,
        Rgba16Unorm => 65535.0,
        _ => 0.0,
    }
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        Self { device: device.clone(), cache: PipelineCache::default() }
    }
}

impl Pipelines {
    /// Returns the pipeline from the targets of `renderer`, supersampled by `ssaa`, to an output of `format`.
    pub(crate) fn get(
        &self,
        renderer: Renderer,
        ssaa: u32,
        format: wgpu::TextureFormat,
    ) -> Result<wgpu::RenderPipeline> {
        let (module, bindings) = shader(renderer);
        self.cache.get((module, ssaa > 1, format), || {
            let name = module.rsplit("::").next().unwrap_or(module);
            // Two entry points, since a software driver executes both sides of a branch.
            let entry = if ssaa > 1 { "supersampled" } else { "fragment" };
            Recipe {
                vertex: (module, &format!("{name}_vertex")),
                fragment: Some((module, &format!("{name}_{entry}"))),
                layouts: &[&layout(&self.device, module, wgpu::ShaderStages::FRAGMENT, bindings)],
                targets: &[Some(format.into())],
                constants: &[("0", f64::from(u8::from(format.is_srgb()))), ("1", steps(format))],
                ..Recipe::PLAIN
            }
            .build(&self.device)
        })
    }
}

/// State of the present stage for one view, bound to its targets.
#[derive(Debug)]
pub(crate) struct PresentState {
    pipelines: Arc<Pipelines>,
    uniform: Uniform,
    group: wgpu::BindGroup,
    renderer: Renderer,
    format: wgpu::TextureFormat,
}

impl PresentState {
    /// Creates the state for the `targets` of `renderer`, and an output of `format`.
    pub fn new(
        context: &Context,
        targets: &Targets,
        renderer: Renderer,
        format: wgpu::TextureFormat,
    ) -> Self {
        let Context { device, .. } = context;
        use wgpu::BindingResource::TextureView;
        let uniform = device.uniform(size_of::<PresentUniform>());
        let footprint = (targets.samples > 1 && !renderer.is_tiles()).then(|| {
            let footprint = match renderer {
                Renderer::Masks(_) => Footprint::disc(targets.samples),
                _ => Footprint::square(targets.samples),
            };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("footprint"),
                contents: bytemuck::bytes_of(&footprint),
                usage: wgpu::BufferUsages::STORAGE,
            })
        });
        let mut resources = vec![uniform.as_entire_binding(), TextureView(&targets.hdr.color)];
        resources.extend(footprint.iter().map(|footprint| footprint.as_entire_binding()));
        if let Some(layers) = &targets.layers {
            resources.extend(layers.presented().map(TextureView));
            resources.push(TextureView(&targets.hdr.depth));
        }
        if let Some(tiles) = &targets.tiles {
            if targets.samples > 1 {
                resources.push(TextureView(&targets.hdr.depth));
            }
            resources.push(TextureView(&tiles.buffers.hair));
            if targets.samples > 1 {
                resources.push(tiles.buffers.surfaces.as_entire_binding());
            }
        }
        let (module, bindings) = shader(renderer);
        let layout = layout(device, module, wgpu::ShaderStages::FRAGMENT, bindings);
        Self {
            pipelines: context.pipelines(),
            group: device.group("present", &layout, &resources),
            uniform,
            renderer,
            format,
        }
    }

    /// Writes the uniform of a frame.
    pub(crate) fn prepare(&self, background: &Background, tone: &ToneMap, targets: &Targets) {
        let uniform = PresentUniform {
            background: *background,
            size: Vec2::new(targets.size[0] as f32, targets.size[1] as f32),
            exposure: tone.exposure,
            shoulder: tone.shoulder.clamp(0.0, 0.99),
            desaturation: tone.desaturation,
            _pad: [0; 3],
        };
        self.uniform.write(0, bytemuck::bytes_of(&uniform));
    }

    /// Presents `targets`, which must be those that the state was created for, into `output`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the pipeline cannot be compiled.
    pub(crate) fn record(
        &self,
        commands: &mut Commands<'_>,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) -> Result<()> {
        let pipeline = self.pipelines.get(self.renderer, targets.ssaa, self.format)?;
        let mut pass = commands.render("present", &[cleared(output)], None);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    }
}
