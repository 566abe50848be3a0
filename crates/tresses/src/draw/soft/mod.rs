//! Shading points: light on body surfaces, evaluated once for several pixels.
//!
//! ```text
//! bodies ─► surface ─► positions, normals ─► list ─► ask (shadow maps, ambient light) ─► points ─► draw::body
//! ```
//!
//! Shadow maps and ambient light are filtered over several millimeters on purpose: visibility by up to 29 taps, fiber
//! counts by splines over nine texels of ten words, the sky by five textures. The result hardly changes from one pixel
//! of a portrait to the next, and took nine tenths of a body's time. Bodies are therefore drawn twice.
//!
//! The first pass (`surface.wesl`) draws positions and normals at a reduced resolution: one point per square of several
//! pixels, `SPACING` apart at the focus of the view. `list` collects the points that see a body, and their neighbors.
//! `evaluate` computes the light with one thread per listed point. Drivers that vectorize shaders execute both sides of
//! a branch and shade whole blocks that a triangle only touches; a list has neither cost.
//!
//! The second pass draws at full resolution. A pixel averages the four points around it, weighted by their distance on
//! the surface, so that light does not leak over edges. Normals, colors, highlights and outlines are evaluated per
//! pixel.
//!
//! Rejected: light at the vertices of the body, which are 2 mm apart on one head and 20 mm on another, and farther
//! after simplification; evaluating light in the fragment shader where no point is near, because lavapipe then
//! evaluates it for all pixels.

use super::canvas::{Canvas, record_parts};
use crate::{
    Camera, Context, Result,
    body::{self, Body},
    constants::STRAND_WORKGROUP,
    gpu::{
        BindBuffer, Binding, Device, Kernel, Uniform,
        bindings::layout,
        commands::{cleared, deep},
        kernel::{self, Job},
        pipeline::{DEPTH_FORMAT, PipelineCache, Recipe},
    },
    light::{self, Sphere},
    shaders::kernels::draw::soft as kernels,
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};
use std::sync::{Mutex, MutexGuard, PoisonError};
use wgpu::util::DeviceExt;

/// Distance between adjacent points at the focus of the view, meters.
const SPACING: f32 = 0.0012;
/// Largest simplification error of the bodies in the first pass, meters: small compared with the spacing, and no larger
/// than in shadow maps.
const STRAY: f32 = 0.2 * SPACING;
/// Smallest and largest edge of a point's square, pixels of the target.
const ACROSS: [u32; 2] = [2, 8];
/// Words per point.
const WORDS: u64 = 8;
/// Initial value of the count buffer: workgroups of `evaluate` (x, y, z) and number of listed points.
const INITIAL_COUNT: [u32; 4] = [0, 1, 1, 0];

const POSITION: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const NORMAL: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Grid of shading points, as the shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct SoftUniform {
    /// Edge of a point's square, pixels of the target.
    pub across: u32,
    /// Points per row.
    pub wide: u32,
    /// Number of rows.
    pub high: u32,
    /// Zone whose points are evaluated; 0 for all.
    pub zone: u32,
    /// First column and row of the evaluated rectangle.
    pub first: [u32; 2],
    /// Columns and rows of the evaluated rectangle.
    pub size: [u32; 2],
}

/// Pipelines of the shading points.
#[derive(Debug)]
pub(super) struct Pipelines {
    frame: wgpu::BindGroupLayout,
    surface: PipelineCache<(), wgpu::RenderPipeline>,
    list: Kernel,
    /// For distant lights only, and for all.
    evaluate: [Kernel; 2],
}

impl Pipelines {
    pub(super) fn new(context: &Context, light: &light::Pipelines) -> Self {
        Self {
            frame: light.frame.clone(),
            surface: PipelineCache::default(),
            list: Kernel::new::<kernels::List>(&context.device),
            evaluate: Kernel::each::<kernels::Evaluate, 2>(
                &context.device,
                ["draw::soft::evaluate::0", "draw::soft::evaluate::2"],
            ),
        }
    }

    fn surface(&self, device: &Device) -> Result<wgpu::RenderPipeline> {
        self.surface.get((), || {
            Recipe {
                vertex: ("draw::soft::surface", "surface_vertex"),
                fragment: Some(("draw::soft::surface", "surface_fragment")),
                layouts: &[&self.frame, &body::layout(device)],
                buffers: &[Some(Body::LAYOUT)],
                targets: &[Some(POSITION.into()), Some(NORMAL.into())],
                depth: Some((true, wgpu::CompareFunction::Greater)),
                ..Recipe::PLAIN
            }
            .build(device)
        })
    }

    /// Returns jobs that compile the pipelines.
    pub(super) fn jobs<'a>(&'a self, device: &'a Device) -> Vec<Job<'a>> {
        let mut jobs = kernel::jobs([&self.list, &self.evaluate[0]]);
        jobs.push(Box::new(move || self.surface(device).map(|_| ())));
        jobs
    }
}

/// Layout of the bind group of the points, `@group(2)` where bodies are drawn.
pub(super) fn points_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    layout(device, "soft", wgpu::ShaderStages::FRAGMENT, &[Binding::Storage, Binding::Storage])
}

/// Shading points for one target size.
#[derive(Debug)]
pub(crate) struct SoftTargets {
    /// Width and height of the target, pixels.
    size: [u32; 2],
    position: wgpu::TextureView,
    normal: wgpu::TextureView,
    depth: wgpu::TextureView,
    uniform: Uniform,
    points: wgpu::Buffer,
    /// Listed points: the index of each, and of the texel on the body that it samples.
    listed: wgpu::Buffer,
    /// Workgroups of `evaluate`, then the number of listed points.
    count: wgpu::Buffer,
    /// [`INITIAL_COUNT`], which each zone copies to the count.
    initial_count: wgpu::Buffer,
    /// Uniform of each zone.
    zones: Mutex<Vec<Uniform>>,
    /// Bind group for drawing bodies.
    pub(super) group: wgpu::BindGroup,
    /// Bind groups of the kernels, by light and uniform: those that the last frame used.
    groups: Mutex<Vec<KernelGroups>>,
}

/// Bind groups of the kernels for one light.
#[derive(Debug)]
struct KernelGroups {
    /// Identity of the light: the bind group of its frame.
    light: wgpu::BindGroup,
    uniform: Uniform,
    list: wgpu::BindGroup,
    evaluate: wgpu::BindGroup,
    is_used: bool,
}

impl SoftTargets {
    /// Approximate GPU memory per pixel of the target, bytes.
    pub const BYTES: u64 = (16 + 8 + 4 + 4 * WORDS + 8) / (ACROSS[0] * ACROSS[0]) as u64;

    /// Creates the points of a target of `size`, pixels, with light from `groups` groups of lights.
    pub(crate) fn new(device: &Device, size: [u32; 2], groups: u32) -> Self {
        let [width, height] = size.map(|side| side.div_ceil(ACROSS[0]));
        let texture = |label, format| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE | usage,
                mapped_at_creation: false,
            })
        };
        let max_points = u64::from(width) * u64::from(height);
        let points =
            buffer("soft points", 4 * WORDS * max_points * u64::from(groups), wgpu::BufferUsages::COPY_DST);
        let uniform = device.storage_uniform(size_of::<SoftUniform>());
        let buffers = [uniform.as_entire_binding(), points.as_entire_binding()];
        Self {
            size,
            position: texture("soft positions", POSITION),
            normal: texture("soft normals", NORMAL),
            depth: texture("soft depth", DEPTH_FORMAT),
            group: device.group("soft", &points_layout(device), &buffers),
            listed: buffer("asked points", 8 * max_points, wgpu::BufferUsages::empty()),
            count: buffer(
                "count of asked points",
                16,
                wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
            ),
            initial_count: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("initial count"),
                contents: bytemuck::bytes_of(&INITIAL_COUNT),
                usage: wgpu::BufferUsages::COPY_SRC,
            }),
            uniform,
            points,
            zones: Mutex::default(),
            groups: Mutex::default(),
        }
    }

    /// Edge of a point's square, pixels of a target supersampled by `ssaa`.
    fn across(camera: &Camera, ssaa: u32, focus: &Sphere) -> u32 {
        let away = (camera.projection * camera.view * focus.center.extend(1.0)).w;
        let pixel = camera.pixel() / ssaa as f32 * away.abs();
        (SPACING / pixel.max(1e-9)).round().clamp(ACROSS[0] as f32, ACROSS[1] as f32) as u32
    }

    /// Records the points of `bodies`.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        canvas: &mut Canvas<'_, '_>,
        bodies: &[&Body],
    ) -> Result<()> {
        let across = Self::across(canvas.camera, canvas.target.ssaa, canvas.focus);
        let [wide, high] = self.size.map(|side| side.div_ceil(across));
        let uniform = SoftUniform { across, wide, high, zone: 0, first: [0; 2], size: [wide, high] };
        self.uniform.write(0, bytemuck::bytes_of(&uniform));

        let surface = pipelines.surface(&canvas.commands.context().device)?;
        let strays: Vec<_> = bodies.iter().map(|body| canvas.stray(body).max(STRAY)).collect();
        let depth = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard };
        let mut pass = canvas.commands.render(
            "body",
            &[cleared(&self.position), cleared(&self.normal)],
            deep(&self.depth, Some(depth)),
        );
        // A fractional viewport keeps the center of each texel at the center of its square, even if the last squares
        // extend beyond the target.
        let [width, height] = self.size.map(|side| side as f32 / across as f32);
        pass.set_viewport([0.0; 2], [width, height]);
        pass.set_pipeline(&surface);
        pass.set_bind_group(0, canvas.frame, &[]);
        record_parts(&mut pass, canvas.parts, |pass, i| bodies[i].record(pass, strays[i]));
        drop(pass);
        self.groups().iter_mut().for_each(|groups| groups.is_used = false);
        if canvas.parts.iter().any(|part| part.number > 0) {
            self.record_zones(pipelines, canvas, bodies, uniform)?;
        } else {
            canvas.commands.context().queue.write_buffer(&self.count, 0, bytemuck::bytes_of(&INITIAL_COUNT));
            self.evaluate(pipelines, canvas, (canvas.light, &self.uniform), wide * high)?;
        }
        self.groups().retain(|groups| groups.is_used);
        Ok(())
    }

    fn groups(&self) -> MutexGuard<'_, Vec<KernelGroups>> {
        // A panic cannot leave the list half-written.
        self.groups.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lists and evaluates the points of each zone in turn, within the bounds of its bodies and with its light.
    fn record_zones(
        &self,
        pipelines: &Pipelines,
        canvas: &mut Canvas<'_, '_>,
        bodies: &[&Body],
        full: SoftUniform,
    ) -> Result<()> {
        canvas.commands.clear(&self.points, None);
        let parts = canvas.parts;
        // A panic cannot leave the list half-written.
        let mut zones = self.zones.lock().unwrap_or_else(PoisonError::into_inner);
        while zones.len() < parts.len() {
            zones.push(canvas.commands.context().device.storage_uniform(size_of::<SoftUniform>()));
        }
        for (part, zone) in parts.iter().zip(zones.iter()) {
            let corners = part.bodies.iter().flat_map(|i| bodies[*i].corners());
            let Some((first, size)) = square(canvas.camera, corners, [full.wide, full.high]) else {
                continue;
            };
            let uniform = SoftUniform { zone: part.number, first, size, ..full };
            zone.write(0, bytemuck::bytes_of(&uniform));
            canvas.commands.copy_part(&self.initial_count, &self.count, 16);
            self.evaluate(pipelines, canvas, (part.light, zone), size[0] * size[1])?;
        }
        Ok(())
    }

    /// Tests `point_count` points, lists the ones that see a body, and evaluates `light` there.
    fn evaluate(
        &self,
        pipelines: &Pipelines,
        canvas: &mut Canvas<'_, '_>,
        (light, uniform): (&light::LightState, &Uniform),
        point_count: u32,
    ) -> Result<()> {
        let mut all = self.groups();
        let known = all.iter().position(|groups| groups.light == light.frame && groups.uniform == *uniform);
        let index = known.unwrap_or_else(|| {
            all.push(self.bind(pipelines, light, uniform));
            all.len() - 1
        });
        let groups = &mut all[index];
        groups.is_used = true;
        let mut pass = canvas.commands.compute("body");
        pipelines.list.record(&mut pass, &groups.list, &[], point_count.div_ceil(STRAND_WORKGROUP));
        let kernel = &pipelines.evaluate[usize::from(light.has_near_lights())];
        kernel.record_indirect(&mut pass, &groups.evaluate, &[], (&self.count, 0));
        pass.end()
    }

    fn bind(&self, pipelines: &Pipelines, light: &light::LightState, uniform: &Uniform) -> KernelGroups {
        let soft = uniform.entire();
        let (positions, normals) = (&self.position, &self.normal);
        let (points, listed, count) = (self.points.entire(), self.listed.entire(), self.count.entire());
        let (transmittance, ambient) = (light.transmittance(), light.ambient());
        let unmapped_grid = light.unmapped_grid();
        let evaluate = kernels::Evaluate {
            transmittance,
            ambient,
            unmapped_grid,
            positions,
            normals,
            soft,
            points,
            listed,
            count,
        };
        KernelGroups {
            light: light.frame.clone(),
            uniform: uniform.clone(),
            list: pipelines.list.bind(&kernels::List { positions, soft, points, listed, count }),
            evaluate: pipelines.evaluate[0].bind(&evaluate),
            is_used: true,
        }
    }
}

/// Returns the rectangle (first column and row, then columns and rows) of a grid of `size` that a box with these
/// corners can cover; `None` if the box is not visible.
fn square(
    camera: &Camera,
    corners: impl Iterator<Item = Vec3>,
    size: [u32; 2],
) -> Option<([u32; 2], [u32; 2])> {
    let clip = camera.projection * camera.view;
    let (mut low, mut high, mut behind, mut any) = (Vec2::INFINITY, Vec2::NEG_INFINITY, false, false);
    for corner in corners {
        let at = clip * corner.extend(1.0);
        any = true;
        behind |= at.w <= 1e-3;
        let position = Vec2::new(at.x, -at.y) / at.w.max(1e-3) * 0.5 + 0.5;
        (low, high) = (low.min(position), high.max(position));
    }
    if behind {
        (low, high) = (Vec2::ZERO, Vec2::ONE);
    }
    // The neighbors of visible points are evaluated too.
    let extent = UVec2::from(size).as_vec2();
    let low = (low * extent - 2.0).max(Vec2::ZERO).floor().min(extent).as_uvec2();
    let high = (high * extent + 2.0).max(Vec2::ZERO).ceil().min(extent).as_uvec2();
    (any && low.cmplt(high).all()).then(|| (low.into(), (high - low).into()))
}
