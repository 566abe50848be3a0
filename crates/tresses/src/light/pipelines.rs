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
    shadow_body: PipelineCache<(), wgpu::RenderPipeline>,
    /// Imports the shadow maps of a scene.
    pub(super) scene: scene::Pipelines,
    /// Stores the hair nearest the light.
    pub(super) splat: Kernel,
    /// Stores which strand is nearest the light.
    pub(super) strand_map: Kernel,
    /// Sums the hair nearest the light over blocks of texels.
    pub(super) summary: Kernel,
    /// Deep opacity maps: computes the first depth layer, adds hair to the layers, accumulates the layers.
    pub(super) deep: [Kernel; 3],
    pub(super) ambient: ambient::Pipelines,
    /// Shading samples.
    pub(super) shading_samples: Kernel,
    /// Radiance of vertices, without and with strand maps.
    shade: [Kernel; 2],
    /// Incoming light of vertices, for shading per pixel by [`crate::draw::classic`].
    pub(super) arrive: Kernel,
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
            splat: maps("light::splat"),
            strand_map: maps("light::strand_map"),
            summary: maps("light::blocks"),
            deep: ["light::front", "light::cover", "light::stack"].map(maps),
            ambient: ambient::Pipelines::new(context),
            gap: device.group("nothing", &nothing, &[]),
            shading_samples: shading("light::shading_samples"),
            shade: ["light::shade::0", "light::shade::1"].map(shading),
            arrive: shading("draw::classic::arrive"),
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
    /// Returns the kernel for the radiance of vertices, with or without strand maps.
    pub(super) fn shade(&self, strand_maps: bool) -> &Kernel {
        &self.shade[usize::from(strand_maps)]
    }

    /// Returns the pipeline that draws a mesh into a shadow map.
    pub(super) fn shadow_body(&self) -> Result<wgpu::RenderPipeline> {
        self.shadow_body.get((), || {
            Recipe {
                vertex: ("light::shadow_body", "shadow_body"),
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
        let [front, cover, stack] = &self.deep;
        let mut kernels =
            vec![&self.splat, front, cover, stack, &self.shading_samples, self.shade(strand_maps)];
        kernels.extend(strand_maps.then_some(&self.strand_map));
        kernels.extend(visible_only.then_some(&self.select_visible));
        kernels.extend(self.ambient.kernels());
        let mut jobs = kernel::jobs(kernels);
        jobs.push(Box::new(|| self.shadow_body().map(|_| ())));
        jobs
    }
}
