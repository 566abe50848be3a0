//! The pipelines of everything from the lights to the picture, and the order to record them in.

use super::{
    Body, Coverage, HairSet, Scene, Targets,
    body::BodyUniform,
    peel::Layers,
    pipeline::Recipe,
    strips::{ByRate, Strips},
    view::ViewUniform,
};
use crate::{
    Result,
    gpu::{
        Binding, Timings,
        bindings::{self, group, layout},
    },
    light::{Ambient, Shade, ShadingModel, ShadowMaps, fiber::FiberTables, lights::LightsUniform},
    present::Present,
    strands::StrandBuffers,
};

/// How a [`DrawStage`] is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawOptions {
    /// Samples per pixel: 1, 4, 8 or 16, as the adapter offers and [`Coverage::check`] allows.
    pub samples: u32,
    /// How strands cover pixels.
    pub coverage: Coverage,
    /// Texels along each edge of a shadow map, brought into 4 to 2048; of a deep opacity map a third,
    /// or fewer where shadows are to be soft. Five maps take 43 bytes per texel
    /// ([`DrawStage::shadow_bytes`]).
    pub shadow_resolution: u32,
    /// Cells along each edge of the grid of light from all sides, brought into 4 to 64
    /// ([`crate::light::ambient`]); each takes 300 bytes.
    pub ambient_cells: u32,
    /// Format of what `present` writes to.
    pub output: wgpu::TextureFormat,
}

impl Default for DrawOptions {
    fn default() -> Self {
        Self {
            samples: 4,
            coverage: Coverage::default(),
            shadow_resolution: 1024,
            ambient_cells: 24,
            output: super::targets::PICTURE_FORMAT,
        }
    }
}

/// Pipelines and per-frame uniforms. Per frame: [`prepare`](Self::prepare), then record
/// [`shadow`](Self::shadow), [`shade`](Self::shade), [`draw`](Self::draw) and
/// [`present`](Self::present).
#[derive(Debug)]
pub struct DrawStage {
    shadow_maps: ShadowMaps,
    ambient: Ambient,
    shade: Shade,
    present: Present,
    view: wgpu::Buffer,
    lights: wgpu::Buffer,
    frame_layout: wgpu::BindGroupLayout,
    frame_group: wgpu::BindGroup,
    hair_layout: wgpu::BindGroupLayout,
    fiber_layout: wgpu::BindGroupLayout,
    body_layout: wgpu::BindGroupLayout,
    body: wgpu::RenderPipeline,
    strips: Strips,
    samples: u32,
    coverage: Coverage,
}

impl DrawStage {
    /// Builds all pipelines.
    pub fn new(device: &wgpu::Device, options: &DrawOptions) -> Self {
        use wgpu::ShaderStages as Stages;
        let both = Stages::VERTEX_FRAGMENT;
        let uniform = |label, size| bindings::uniform(device, label, size);
        let view = uniform("view", size_of::<ViewUniform>());
        let lights = uniform("lights", size_of::<LightsUniform>());
        use Binding::{Comparison, DepthArray, Sampler, Storage, Texture3d, Uniform};
        let entries = [Uniform, Uniform, DepthArray, Comparison, Storage, Storage, Texture3d, Sampler];
        let frame_layout = layout(device, "frame", both, &entries);
        let hair_layout = layout(device, "hair", both, &[Uniform, Storage, Storage, Storage]);
        let body_layout = layout(device, "body", both, &[Uniform]);
        let fiber_layout = FiberTables::layout(device);
        let shadow_maps = ShadowMaps::new(device, options.shadow_resolution, &body_layout);
        let ambient = Ambient::new(device, options.ambient_cells, &lights, shadow_maps.resources());
        let [maps, comparison, hair, blocks] = shadow_maps.resources();
        let [grid, linear] = ambient.resources();
        let frame = [
            view.as_entire_binding(),
            lights.as_entire_binding(),
            maps,
            comparison,
            hair,
            blocks,
            grid,
            linear,
        ];
        let frame_group = group(device, "frame", &frame_layout, &frame);
        let body = Recipe {
            module: "draw::body",
            entry: ["body_vertex", "body_fragment"],
            layouts: &[Some(&frame_layout), Some(&body_layout)],
            buffers: &[Some(Body::LAYOUT)],
            targets: &[Some(super::targets::HDR_FORMAT.into())],
            depth: Some((true, wgpu::CompareFunction::Greater)),
            samples: options.samples,
            alpha_to_coverage: false,
        };
        Self {
            shade: Shade::new(device, &fiber_layout),
            present: Present::new(device, options.samples, options.coverage, options.output),
            body: body.build(device),
            strips: Strips::new(device, options, [&frame_layout, &hair_layout, &fiber_layout]),
            samples: options.samples,
            coverage: options.coverage,
            shadow_maps,
            ambient,
            view,
            lights,
            frame_layout,
            frame_group,
            hair_layout,
            fiber_layout,
            body_layout,
        }
    }

    pub(crate) fn body_layout(&self) -> &wgpu::BindGroupLayout {
        &self.body_layout
    }

    /// How strands cover pixels.
    pub fn coverage(&self) -> Coverage {
        self.coverage
    }

    /// What pipelines that draw strips bind: the frame's group, and the layouts of it, of hair and of its
    /// fibres' tables.
    pub(crate) fn hair_groups(&self) -> (&wgpu::BindGroup, [&wgpu::BindGroupLayout; 3]) {
        (&self.frame_group, [&self.frame_layout, &self.hair_layout, &self.fiber_layout])
    }

    pub(crate) fn fiber_layout(&self) -> &wgpu::BindGroupLayout {
        &self.fiber_layout
    }

    pub(crate) fn bind_hair(
        &self,
        device: &wgpu::Device,
        uniform: &wgpu::Buffer,
        strands: &StrandBuffers,
        shaded: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        group(
            device,
            "hair",
            &self.hair_layout,
            &[
                uniform.as_entire_binding(),
                strands.vertices.as_entire_binding(),
                strands.strands.as_entire_binding(),
                shaded.as_entire_binding(),
            ],
        )
    }

    pub(crate) fn bind_shade(
        &self,
        device: &wgpu::Device,
        uniform: &wgpu::Buffer,
        strands: &StrandBuffers,
        shaded: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let view = self.view.as_entire_binding();
        let [lights, maps, comparison, hair, blocks] = self.light_resources();
        let [grid, linear] = self.ambient.resources();
        let frame = [view, lights, maps, comparison, hair, blocks, grid, linear];
        self.shade.bind(device, frame, strands, uniform, shaded)
    }

    /// What the light stage offers to those that ask for light.
    pub(crate) fn light_resources(&self) -> [wgpu::BindingResource<'_>; 5] {
        let [maps, comparison, hair, blocks] = self.shadow_maps.resources();
        [self.lights.as_entire_binding(), maps, comparison, hair, blocks]
    }

    /// And what it offers to those that ask for light from all sides.
    pub(crate) fn ambient_resources(&self) -> [wgpu::BindingResource<'_>; 2] {
        self.ambient.resources()
    }

    pub(crate) fn bind_splat(
        &self,
        device: &wgpu::Device,
        uniform: &wgpu::Buffer,
        strands: &StrandBuffers,
    ) -> wgpu::BindGroup {
        self.shadow_maps.bind_splat(device, &self.lights, uniform, strands)
    }

    pub(crate) fn bind_ambient(
        &self,
        device: &wgpu::Device,
        uniform: &wgpu::Buffer,
        strands: &StrandBuffers,
    ) -> wgpu::BindGroup {
        self.ambient.bind_hair(device, &self.lights, uniform, strands)
    }

    pub(crate) fn ambient_cells(&self) -> u32 {
        self.ambient.cells()
    }

    pub(crate) fn bind_surface(&self, device: &wgpu::Device, buffers: [&wgpu::Buffer; 3]) -> wgpu::BindGroup {
        self.ambient.bind_body(device, buffers)
    }

    pub(crate) fn bind_body(&self, device: &wgpu::Device, uniform: &wgpu::Buffer) -> wgpu::BindGroup {
        group(device, "body", &self.body_layout, &[uniform.as_entire_binding()])
    }

    /// Writes the frame's values; before the commands recorded with them are submitted.
    pub fn prepare(
        &self,
        queue: &wgpu::Queue,
        scene: &Scene,
        targets: &Targets,
        hair: Option<&HairSet>,
        body: Option<&Body>,
    ) {
        let write = |buffer, bytes: &[u8]| queue.write_buffer(buffer, 0, bytes);
        let view = scene.view.uniform(targets.samples, targets.ssaa, &scene.tone);
        let mut lights = scene.lights.uniform(&scene.shadows, &scene.focus, self.shadow_maps.resolution);
        if scene.shadows.follows_ambient() {
            lights.ambient = self.ambient.cells();
        }
        write(&self.view, bytemuck::bytes_of(&view));
        self.shadow_maps.prepare(queue, &lights);
        self.present.prepare(queue, scene, targets);
        if let Some(hair) = hair {
            let uniform = scene.hair.uniform(scene.shading, &hair.drawn, hair.rest_count, hair.splat);
            write(&hair.uniform, bytemuck::bytes_of(&uniform));
            if scene.hair.model == ShadingModel::Fiber {
                let fiber = &scene.hair.fiber;
                hair.fiber.fill(queue, &fiber.shape, fiber.density_back);
                let absorption = 0.5 * (fiber.root_absorption + fiber.tip_absorption);
                lights.passes = hair.fiber.passes(absorption);
                lights.forward = fiber.density_forward.clamp(0.0, 1.0);
            } else {
                lights.passes = glam::Vec3::splat(1.0 - scene.hair.opacity.clamp(0.0, 1.0));
                lights.forward = 1.0;
            }
        }
        write(&self.lights, bytemuck::bytes_of(&lights));
        if let Some(body) = body {
            let uniform: BodyUniform = scene.body.uniform(&scene.pose, body.surface.outward);
            write(&body.uniform, bytemuck::bytes_of(&uniform));
        }
    }

    /// Records the shadow maps of the lights of `scene` that are on, and light from all sides.
    pub fn shadow(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut timings: Option<&mut Timings>,
        scene: &Scene,
        hair: Option<&HairSet>,
        body: Option<&Body>,
    ) {
        self.shadow_maps.record(encoder, timings.as_deref_mut(), scene, hair, body);
        if scene.shadows.follows_ambient() {
            self.ambient.record(encoder, timings, hair, body);
        }
    }

    /// Bytes of GPU memory of the shadow maps.
    pub fn shadow_bytes(&self) -> u64 {
        self.shadow_maps.bytes()
    }

    /// Bytes of GPU memory of light from all sides.
    pub fn ambient_bytes(&self) -> u64 {
        self.ambient.bytes()
    }

    /// Records the shading of strand vertices.
    pub fn shade(&self, encoder: &mut wgpu::CommandEncoder, timings: Option<&mut Timings>, hair: &HairSet) {
        self.shade.record(encoder, timings, hair);
    }

    /// Targets that fit the stage, for a picture of `width` × `height` pixels, supersampled by
    /// `ssaa` (1, 2 or 4) along each axis.
    ///
    /// # Errors
    /// As [`Targets::new`].
    pub fn targets(&self, device: &wgpu::Device, width: u32, height: u32, ssaa: u32) -> Result<Targets> {
        let targets = Targets::new(device, width, height, self.samples, ssaa)?;
        Ok(match &self.strips {
            Strips::Peeled(peel) => targets.with_layers(device, |texture| Layers::new(device, peel, texture)),
            _ => targets,
        })
    }

    /// Records hair and body into `targets`, a pass each, so that each has its own time.
    ///
    /// # Panics
    /// When the stage peels and [`targets`](Self::targets) has not made `targets`.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut timings: Option<&mut Timings>,
        scene: &Scene,
        targets: &Targets,
        hair: Option<&HairSet>,
        body: Option<&Body>,
    ) {
        if self.body_first() {
            self.draw_body(encoder, timings.as_deref_mut(), targets, body);
            self.draw_hair(encoder, timings, scene, targets, hair);
        } else {
            self.draw_hair(encoder, timings.as_deref_mut(), scene, targets, hair);
            self.draw_body(encoder, timings, targets, body);
        }
    }

    /// Whether the body is to be drawn before the hair: when this is blended. Else after it: the
    /// body's shading costs more per pixel, and most of the scalp is hidden.
    pub fn body_first(&self) -> bool {
        matches!(self.strips, Strips::Peeled(_))
    }

    /// Records the hair; clears `targets` unless the [body comes first](Self::body_first).
    pub fn draw_hair(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        scene: &Scene,
        targets: &Targets,
        hair: Option<&HairSet>,
    ) {
        let Some(hair) = hair else {
            match &self.strips {
                Strips::Peeled(peel) => peel.clear(encoder, targets),
                _ => drop(self.pass(encoder, timings, "hair", true, targets)),
            }
            return;
        };
        self.record_hair(encoder, timings, scene, targets, hair, true);
    }

    /// Records once more how thick the hair behind the last peeled layer is, which [`draw_hair`](Self::draw_hair)
    /// has recorded: for tools that time it on its own. Returns whether this stage peels at all.
    pub fn draw_thickness(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        targets: &Targets,
        hair: &HairSet,
    ) -> bool {
        let Strips::Peeled(peel) = &self.strips else { return false };
        peel.record_thickness(encoder, None, &self.frame_group, scene.shading, targets, hair);
        true
    }

    /// Records the hair over what is in `targets`. A stage that peels has no use for it.
    pub(crate) fn draw_hair_over(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        scene: &Scene,
        targets: &Targets,
        hair: &HairSet,
    ) {
        self.record_hair(encoder, timings, scene, targets, hair, false);
    }

    fn record_hair(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut timings: Option<&mut Timings>,
        scene: &Scene,
        targets: &Targets,
        hair: &HairSet,
        clear: bool,
    ) {
        let mut strips = |pipelines: &ByRate, clear| {
            let mut pass = self.pass(encoder, timings.as_deref_mut(), "hair", clear, targets);
            pass.set_pipeline(pipelines.of(scene.shading));
            hair.record_strips(&mut pass);
        };
        match &self.strips {
            Strips::Once(all) => strips(all, clear),
            Strips::DepthFirst { depth, color } => {
                strips(depth, clear);
                strips(color, false);
            }
            Strips::Peeled(peel) => {
                peel.record(encoder, timings, &self.frame_group, scene.shading, targets, hair);
            }
        }
    }

    /// Records the body; clears `targets` when it [comes first](Self::body_first).
    pub fn draw_body(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        targets: &Targets,
        body: Option<&Body>,
    ) {
        if body.is_none() && !self.body_first() {
            return;
        }
        let mut pass = self.pass(encoder, timings, "body", self.body_first(), targets);
        if let Some(body) = body {
            pass.set_pipeline(&self.body);
            body.record(&mut pass);
        }
    }

    /// A pass into the HDR target with the frame's group bound.
    pub(crate) fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        name: &'static str,
        clear: bool,
        targets: &Targets,
    ) -> wgpu::RenderPass<'e> {
        let color = if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
        let depth = if clear { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &targets.hdr,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: color, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations { load: depth, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: timings.and_then(|timings| timings.render(name)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass
    }

    /// Records the finished picture of `targets` into `output`, which is [`Targets::picture`] or
    /// any view of the same size and of the format the stage was built for.
    pub fn present(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) {
        self.present.record(device, encoder, timings, targets, output);
    }
}
