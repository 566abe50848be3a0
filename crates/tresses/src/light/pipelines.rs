//! Kernels and pipelines of the light stage, and the bind group layouts that draw stages share with it.

use super::{
    ambient,
    fiber::FiberTables,
    frame::{FRAME, HAIR},
    scene,
};
use crate::{
    Context, Result,
    body::{self, Body},
    gpu::{
        Binding, Device, Kernel, PipelineSet,
        bindings::layout,
        kernel::{self, Job},
        pipeline::{PipelineCache, Recipe},
    },
    shaders::kernels::light as kernels,
};

/// Pipelines of the light stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    /// Layout of a view's `@group(0)`.
    pub(crate) frame: wgpu::BindGroupLayout,
    /// Layout of a groom's `@group(1)`.
    pub(crate) hair: wgpu::BindGroupLayout,
    /// Layout of the fiber tables, `@group(2)`.
    pub(crate) fiber: wgpu::BindGroupLayout,
    pub(super) layer: wgpu::BindGroupLayout,
    shadow_body: PipelineCache<bool, wgpu::RenderPipeline>,
    /// Imports the shadow maps of a scene.
    pub(super) scene: scene::Pipelines,
    /// Stores the hair nearest the light: for distant lights only, and for all; then the same for hair of other zones.
    pub(super) splat: [Kernel; 4],
    /// Stores which strand is nearest the light: for distant lights only, and for all.
    pub(super) strand_map: [Kernel; 2],
    /// Sums the hair nearest the light over blocks of texels.
    pub(super) summary: Kernel,
    /// Deep opacity maps: computes the first depth layer, and accumulates the layers.
    pub(super) deep: [Kernel; 2],
    /// Adds hair to the layers: as `splat`.
    pub(super) cover: [Kernel; 4],
    pub(super) ambient: ambient::Pipelines,
    /// Shading samples: for distant lights only, and for all.
    shading_samples: [Kernel; 2],
    /// Radiance of vertices, by the bits of `LIGHT_OPTIONS`.
    shade: [Kernel; 4],
    /// Incoming light of vertices, for shading per pixel by [`crate::draw::classic`].
    pub(super) arrive: [Kernel; 2],
    /// Selects the visible knots and spans.
    pub(super) select_visible: Kernel,
    /// A list that selects all knots and spans.
    pub(super) all: wgpu::Buffer,
    /// An empty group, because the fiber tables are `@group(2)` as in the draw pipelines.
    pub(super) gap: wgpu::BindGroup,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        use wgpu::ShaderStages as Stages;
        let both = Stages::VERTEX_FRAGMENT;
        let fiber = FiberTables::layout(device);
        let nothing = layout(device, "nothing", Stages::COMPUTE, &[]);
        let maps = |module| Kernel::named::<kernels::ShadowMaps>(&context.device, module, &[]);
        let shading =
            |module| Kernel::named::<kernels::Shading>(&context.device, module, &[&nothing, &fiber]);
        Self {
            device: device.clone(),
            frame: layout(device, "frame", both | Stages::COMPUTE, &FRAME),
            hair: layout(device, "hair", both, &HAIR),
            layer: layout(device, "shadow layer", Stages::VERTEX, &[Binding::UniformDynamic]),
            shadow_body: PipelineCache::default(),
            scene: scene::Pipelines::new(context),
            splat: ["light::splat::0", "light::splat::2", "light::splat::4", "light::splat::6"].map(maps),
            strand_map: ["light::strand_map::0", "light::strand_map::2"].map(maps),
            summary: maps("light::blocks"),
            deep: ["light::front", "light::stack"].map(maps),
            cover: ["light::cover::0", "light::cover::2", "light::cover::4", "light::cover::6"].map(maps),
            ambient: ambient::Pipelines::new(context),
            gap: device.group("nothing", &nothing, &[]),
            shading_samples: ["light::shading_samples::0", "light::shading_samples::2"].map(shading),
            shade: ["light::shade::0", "light::shade::1", "light::shade::2", "light::shade::3"].map(shading),
            arrive: ["draw::classic::arrive::0", "draw::classic::arrive::2"].map(shading),
            select_visible: Kernel::new::<kernels::SelectVisible>(&context.device),
            all: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("all strands"),
                size: 4,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            fiber: fiber.clone(),
        }
    }
}

impl Pipelines {
    /// Returns the kernel for shading samples, for distant lights only or for all.
    pub(super) fn shading_samples(&self, near_lights: bool) -> &Kernel {
        &self.shading_samples[usize::from(near_lights)]
    }

    /// Returns the kernel for the radiance of vertices.
    pub(super) fn shade(&self, strand_maps: bool, near_lights: bool) -> &Kernel {
        &self.shade[usize::from(strand_maps) + 2 * usize::from(near_lights)]
    }

    /// Returns the pipeline that draws a mesh into a shadow map: for parallel rays, or for all views and other zones.
    pub(super) fn shadow_body(&self, near: bool) -> Result<wgpu::RenderPipeline> {
        self.shadow_body.get(near, || {
            Recipe {
                vertex: ("light::shadow_body", if near { "shadow_body_near" } else { "shadow_body" }),
                layouts: &[&self.layer, &body::layout(&self.device)],
                buffers: &[Some(Body::LAYOUT)],
                depth: Some((true, wgpu::CompareFunction::Less)),
                ..Recipe::PLAIN
            }
            .build(&self.device)
        })
    }

    /// Returns the jobs that compile all pipelines for a frame with default shadows. `visible_only`: the frame shades
    /// only visible hair. `strand_maps`: it uses strand maps.
    pub(crate) fn jobs(&self, visible_only: bool, strand_maps: bool) -> Vec<Job<'_>> {
        let [front, stack] = &self.deep;
        let mut kernels = vec![&self.splat[0], front, &self.cover[0], stack];
        kernels.extend([self.shading_samples(false), self.shade(strand_maps, false)]);
        kernels.extend(strand_maps.then_some(&self.strand_map[0]));
        kernels.extend(visible_only.then_some(&self.select_visible));
        kernels.extend(self.ambient.kernels());
        let mut jobs = kernel::jobs(kernels);
        jobs.push(Box::new(|| self.shadow_body(false).map(|_| ())));
        jobs
    }
}
