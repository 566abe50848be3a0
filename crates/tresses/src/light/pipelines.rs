//! The kernels and the pipeline of the stage, and the layouts of what it offers to those that draw.

use super::{ambient, fiber::FiberTables, scene};
use crate::{
    Context, Result,
    body::{self, Body},
    gpu::{
        Binding, Device, Kernel, PipelineSet,
        bindings::layout,
        kernel::{self, Job},
        pipeline::{Made, Recipe},
    },
};

/// What everything that is drawn in light binds as `@group(0)`: camera, lights, the body's maps and how they are
/// compared, the hair's maps, their blocks, light from all sides and how it is read.
pub(crate) const FRAME: [Binding; 8] = [
    Binding::Uniform,
    Binding::Uniform,
    Binding::DepthArray,
    Binding::Comparison,
    Binding::Storage,
    Binding::Storage,
    Binding::Texture3d,
    Binding::Sampler,
];

/// A groom's share of `@group(1)`: its uniform, vertices, strands and shaded colours.
const HAIR: [Binding; 4] = [Binding::Uniform, Binding::Storage, Binding::Storage, Binding::Storage];

/// What the kernels that shade bind, as in `light::knot`.
pub(super) fn shade_bindings() -> Vec<Binding> {
    use Binding::{Storage, StorageMut};
    let last = HAIR.len() - 1;
    [&FRAME[..], &HAIR[..last], &[StorageMut, StorageMut, Storage]].concat()
}

/// The pipelines of the stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    /// Of a view's `@group(0)`.
    pub(crate) frame: wgpu::BindGroupLayout,
    /// Of a groom's `@group(1)`.
    pub(crate) hair: wgpu::BindGroupLayout,
    /// Of the tables of its fibres, `@group(2)`.
    pub(crate) fiber: wgpu::BindGroupLayout,
    pub(super) layer: wgpu::BindGroupLayout,
    shadow_body: Made<(), wgpu::RenderPipeline>,
    /// Shadow maps of a scene.
    pub(super) scene: scene::Pipelines,
    /// The hair nearest the light.
    pub(super) splat: Kernel,
    /// Which strand is nearest the light.
    pub(super) strand_map: Kernel,
    /// The hair nearest the light in blocks of texels.
    pub(super) summary: Kernel,
    /// Deep opacity maps: where the hair's front is, hair into the layers, sums over the layers.
    pub(super) deep: [Kernel; 3],
    pub(super) ambient: ambient::Pipelines,
    /// What varies slowly along strands, radiance by it, and for shading per pixel what arrives.
    pub(super) knots: Kernel,
    /// Without strand maps, and with them.
    shade: [Kernel; 2],
    pub(super) arrive: Kernel,
    /// Which knots and spans are seen.
    pub(super) choose: Kernel,
    /// The list that asks for all of them.
    pub(super) all: wgpu::Buffer,
    /// Nothing: the fibres' tables are `@group(2)`, as in the pipelines that draw.
    pub(super) gap: wgpu::BindGroup,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        use Binding::{Storage, StorageMut, Uniform, UniformDynamic};
        use wgpu::ShaderStages as Stages;
        let both = Stages::VERTEX_FRAGMENT;
        let fiber = FiberTables::layout(device);
        let nothing = layout(device, "nothing", Stages::COMPUTE, &[]);
        // One group for all kernels of the maps: those that need less of it leave the rest alone.
        let maps = |module| {
            let entries = [Uniform, Uniform, Storage, Storage, StorageMut, StorageMut, Storage];
            Kernel::new(&context.device, module, &entries)
        };
        let shading =
            |module| Kernel::beside(&context.device, module, &shade_bindings(), &[&nothing, &fiber]);
        Self {
            device: device.clone(),
            frame: layout(device, "frame", both | Stages::COMPUTE, &FRAME),
            hair: layout(device, "hair", both, &HAIR),
            layer: layout(device, "shadow layer", Stages::VERTEX, &[UniformDynamic]),
            shadow_body: Made::default(),
            scene: scene::Pipelines::new(context),
            splat: maps("light::splat"),
            strand_map: maps("light::strand_map"),
            summary: maps("light::blocks"),
            deep: ["light::front", "light::cover", "light::stack"].map(maps),
            ambient: ambient::Pipelines::new(context),
            gap: device.group("nothing", &nothing, &[]),
            knots: shading("light::knots"),
            shade: ["light::shade::0", "light::shade::1"].map(shading),
            arrive: shading("light::arrive"),
            choose: Kernel::new(
                &context.device,
                "light::choose",
                &[Uniform, Storage, StorageMut, StorageMut, StorageMut],
            ),
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
    /// The radiance of vertices, with strand maps or without.
    pub(super) fn shade(&self, strand_maps: bool) -> &Kernel {
        &self.shade[usize::from(strand_maps)]
    }

    /// Draws a body into a shadow map.
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

    /// What compiles all that a picture with shadows by default needs; of one that shades only what is seen if
    /// `chosen`, and of one that asks `strand_maps`.
    pub(crate) fn jobs(&self, chosen: bool, strand_maps: bool) -> Vec<Job<'_>> {
        let [front, cover, stack] = &self.deep;
        let mut kernels = vec![&self.splat, front, cover, stack, &self.knots, self.shade(strand_maps)];
        kernels.extend(strand_maps.then_some(&self.strand_map));
        kernels.extend(chosen.then_some(&self.choose));
        kernels.extend(self.ambient.kernels());
        let mut jobs = kernel::jobs(kernels);
        jobs.push(Box::new(|| self.shadow_body().map(|_| ())));
        jobs
    }
}
