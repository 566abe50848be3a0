//! From linear radiance to the picture: background, tone mapping, resolve, sRGB.
//!
//! All that a pixel shows is averaged in linear light, premultiplied, and the mean is composed with the background and
//! tone mapped once, as a camera does it. Samples that are tone mapped first make bright strands dull: the brightest
//! tenth of blond hair had 0.88 to 0.91 of the path tracer's light in the finished picture, now 0.99 to 1.00 (Sintel,
//! TressFX's). There is no bound on bright samples: pictures change as little from frame to frame as before, a
//! bound at three times white changes next to nothing, and one at half of that takes 7 to 13 % of blond hair's light.
//!
//! With twofold supersampling the mean is over the
//! texels that the original's five bilinear samples read (`taps.wesl`), a little wider than the
//! pixel; with more, over the pixel's square. Masks of several samples are averaged over a disc that is
//! wider than the pixel when they are few (`footprint.rs`). A single sample per pixel is blended with its
//! neighbours along the strand or edge that it belongs to, which the structure tensor of its
//! neighbourhood finds. Peeled hair lies over the rest (`layers.wesl`), hair of tiles over each of the two surfaces
//! that a pixel can show (`tiled.wesl`).

mod background;
mod footprint;

pub use background::Background;
pub use footprint::Footprint;

use bytemuck::{Pod, Zeroable};
use glam::Vec2;
use wgpu::util::DeviceExt;

use crate::{
    Context, Result,
    camera::ToneMap,
    draw::{Coverage, Targets},
    gpu::{
        Binding, Commands, Device, PipelineSet,
        bindings::layout,
        commands::cleared,
        pipeline::{Made, Recipe},
    },
};
use std::sync::Arc;

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
    /// Unused.
    pub _pad: [u32; 3],
}

/// The pipelines of the stage, each made when it is first needed.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    /// By shader, whether targets are larger than the picture, and format of the output.
    made: Made<(&'static str, bool, wgpu::TextureFormat), wgpu::RenderPipeline>,
}

/// The shader for targets of so many samples with hair in them by `coverage`, and what it binds.
fn shader(coverage: Coverage, samples: u32) -> (&'static str, &'static [Binding]) {
    use Binding::{Depth, DepthMultisampled, Storage, Texture2d, TextureMultisampled, Uniform};
    match (coverage, samples) {
        (Coverage::DepthPeeling { .. }, _) => {
            ("present::layers", &[Uniform, Texture2d, Texture2d, Texture2d, Texture2d, Depth])
        }
        (Coverage::Tiles, 1) => ("present::tiled_one", &[Uniform, Texture2d, Texture2d]),
        (Coverage::Tiles, _) => {
            ("present::tiled", &[Uniform, TextureMultisampled, DepthMultisampled, Texture2d, Storage])
        }
        (_, 1) => ("present::single", &[Uniform, Texture2d]),
        _ => ("present::resolve", &[Uniform, TextureMultisampled, Storage]),
    }
}

/// Into how many steps `format` parts what lies between black and white; 0 for floats.
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
        Self { device: device.clone(), made: Made::default() }
    }
}

impl Pipelines {
    /// From targets of so many samples, `ssaa` times as large as the picture, with hair in them by `coverage` into an
    /// output of `format`.
    pub(crate) fn get(
        &self,
        coverage: Coverage,
        (samples, ssaa): (u32, u32),
        format: wgpu::TextureFormat,
    ) -> Result<wgpu::RenderPipeline> {
        let (module, bindings) = shader(coverage, samples);
        self.made.get((module, ssaa > 1, format), || {
            let name = module.rsplit("::").next().unwrap_or(module);
            // Two entries: a software driver runs both sides of a branch.
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

/// What the stage has of one view: it is bound to its targets.
#[derive(Debug)]
pub struct State {
    pipelines: Arc<Pipelines>,
    uniform: wgpu::Buffer,
    group: wgpu::BindGroup,
    coverage: Coverage,
    format: wgpu::TextureFormat,
}

impl State {
    /// For `targets` with hair in them by `coverage`, and an output of `format`.
    pub fn new(
        context: &Context,
        targets: &Targets,
        coverage: Coverage,
        format: wgpu::TextureFormat,
    ) -> Self {
        let Context { device, .. } = context;
        use wgpu::BindingResource::TextureView;
        let uniform = crate::gpu::bindings::uniform(device, "present", size_of::<PresentUniform>());
        let footprint = (targets.samples > 1 && !coverage.is_tiled()).then(|| {
            let footprint = match coverage {
                Coverage::SampleMask => Footprint::disc(targets.samples),
                _ => Footprint::square(targets.samples),
            };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("footprint"),
                contents: bytemuck::bytes_of(&footprint),
                usage: wgpu::BufferUsages::STORAGE,
            })
        });
        let mut resources = vec![uniform.as_entire_binding(), TextureView(&targets.hdr)];
        resources.extend(footprint.iter().map(|footprint| footprint.as_entire_binding()));
        if let Some(layers) = &targets.layers {
            resources.extend(layers.presented().map(TextureView));
            resources.push(TextureView(&targets.depth));
        }
        if let Some(tiles) = &targets.tiles {
            if targets.samples > 1 {
                resources.push(TextureView(&targets.depth));
            }
            resources.push(TextureView(&tiles.hair));
            if targets.samples > 1 {
                resources.push(tiles.surfaces.as_entire_binding());
            }
        }
        let (module, bindings) = shader(coverage, targets.samples);
        let layout = layout(device, module, wgpu::ShaderStages::FRAGMENT, bindings);
        Self {
            pipelines: context.pipelines(),
            group: device.group("present", &layout, &resources),
            uniform,
            coverage,
            format,
        }
    }

    /// Writes the uniform of a frame.
    pub(crate) fn prepare(
        &self,
        context: &Context,
        background: &Background,
        tone: &ToneMap,
        targets: &Targets,
    ) {
        let Context { queue, .. } = context;
        let uniform = PresentUniform {
            background: *background,
            size: Vec2::new(targets.size[0] as f32, targets.size[1] as f32),
            exposure: tone.exposure,
            shoulder: tone.shoulder.clamp(0.0, 0.99),
            desaturation: tone.desaturation,
            _pad: [0; 3],
        };
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// Records the finished picture of `targets`, those it was made for, into `output`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the pipeline cannot be made.
    pub(crate) fn record(
        &self,
        commands: &mut Commands<'_>,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) -> Result<()> {
        let pipeline = self.pipelines.get(self.coverage, (targets.samples, targets.ssaa), self.format)?;
        let mut pass = commands.render("present", &[cleared(output)], None);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    }
}
