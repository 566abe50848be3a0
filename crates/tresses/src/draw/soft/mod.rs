//! Light that changes over millimetres, asked once for several pixels of a body.
//!
//! ```text
//! bodies ─► surface ─► positions, normals ─► list ─► ask (shadow maps, ambient light) ─► points ─► draw::body
//! ```
//!
//! What arrives at a point of a body of each light and from all sides is read from maps that are smoothed over
//! several millimetres on purpose: shares by filters of up to 29 taps, fibres by splines over nine texels of ten words,
//! the sky from five textures. It hardly changes from one pixel of a portrait to the next, and it was nine tenths of a
//! body's time. So bodies are drawn twice.
//!
//! First small (`surface.wesl`): position and normal, one pixel for several of the target's, `SPACING` apart where
//! the picture's focus is. `list` collects those that see a body, and those beside them; `ask`, one thread for each,
//! asks for the light there. Drivers that run shaders on vectors take both ways of a branch and shade whole blocks that a
//! triangle only touches: a list has neither.
//!
//! Then in the target's size: a pixel takes the mean of the four points around it, weighted by how near they lie to its
//! tangent plane, so that light does not leak over edges. Normals, colours, highlights and outlines are the pixel's own.
//!
//! Rejected: light at the body's vertices, which are 2 mm apart on one head and 20 on another, and farther once
//! simplified; asking in the fragment shader where no point lies in the plane, for which lavapipe asks for all.

use super::record::{Canvas, canvas_parts};
use crate::{
    Camera, Context, Result,
    body::{self, Body},
    constants::STRAND_WORKGROUP,
    gpu::{
        Binding, Device, Kernel,
        bindings::{self, layout},
        commands::{cleared, deep},
        kernel::{self, Job},
        pipeline::{DEPTH_FORMAT, Made, Recipe},
    },
    light::{self, Sphere},
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};
use std::sync::{Mutex, PoisonError};

/// Metres from one point to the next where the picture's focus is.
const SPACING: f32 = 0.0012;
/// How far the bodies that are asked may stray from those that are drawn, metres: little beside the spacing, and no more
/// than they do in shadow maps.
const STRAY: f32 = 0.2 * SPACING;
/// Pixels of the target along each edge of a point's square, at least and at most.
const ACROSS: [u32; 2] = [2, 8];
/// Words of a point.
const WORDS: u64 = 8;
/// Workgroups that ask, and points that are asked, before any is listed.
const NONE_ASKED: [u32; 4] = [0, 1, 1, 0];
/// Where that is in the buffer of a zone, bytes.
const COUNT_AT: u64 = 32;

const POSITION: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const NORMAL: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What the shaders know of the points.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SoftUniform {
    /// Pixels of the target along each edge of a point's square.
    pub across: u32,
    /// Points in a row.
    pub wide: u32,
    /// Rows.
    pub high: u32,
    /// The number of the zone whose points are listed and asked; 0 for all.
    pub zone: u32,
    /// The first column and row of points that are looked at.
    pub first: [u32; 2],
    /// How many columns and rows.
    pub size: [u32; 2],
}

/// The pipelines.
#[derive(Debug)]
pub(super) struct Pipelines {
    frame: wgpu::BindGroupLayout,
    surface: Made<(), wgpu::RenderPipeline>,
    list: Kernel,
    ask: Kernel,
}

impl Pipelines {
    pub(super) fn new(context: &Context, light: &light::Pipelines) -> Self {
        use Binding::{Storage, StorageMut, Texels2d};
        let own = [Texels2d, Texels2d, Storage, StorageMut, Storage, Storage];
        Self {
            frame: light.frame.clone(),
            surface: Made::default(),
            list: Kernel::new(
                &context.device,
                "draw::soft::list",
                &[Texels2d, Storage, StorageMut, StorageMut, StorageMut],
            ),
            ask: Kernel::new(&context.device, "draw::soft::ask", &[&light::FRAME[..], &own].concat()),
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

    /// What compiles them.
    pub(super) fn jobs<'a>(&'a self, device: &'a Device) -> Vec<Job<'a>> {
        let mut jobs = kernel::jobs([&self.list, &self.ask]);
        jobs.push(Box::new(move || self.surface(device).map(|_| ())));
        jobs
    }
}

/// The layout of the points' group, `@group(2)` where bodies are drawn.
pub(super) fn points_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    layout(device, "soft", wgpu::ShaderStages::FRAGMENT, &[Binding::Storage, Binding::Storage])
}

/// The points of one picture size.
#[derive(Debug)]
pub(crate) struct Soft {
    /// Of the target, pixels.
    size: [u32; 2],
    position: wgpu::TextureView,
    normal: wgpu::TextureView,
    depth: wgpu::TextureView,
    uniform: wgpu::Buffer,
    points: wgpu::Buffer,
    /// Which points are asked where on the body.
    asked: wgpu::Buffer,
    /// How many workgroups that takes, and how many points they are.
    count: wgpu::Buffer,
    /// Of each zone.
    zones: Mutex<Vec<wgpu::Buffer>>,
    /// For those who draw bodies.
    pub(super) group: wgpu::BindGroup,
}

impl Soft {
    /// Bytes of GPU memory per pixel of the target, nearly.
    pub const BYTES: u64 = (16 + 8 + 4 + 4 * WORDS + 8) / (ACROSS[0] * ACROSS[0]) as u64;

    /// For a target of `size`, pixels.
    pub(crate) fn new(device: &Device, size: [u32; 2]) -> Self {
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
        let most = u64::from(width) * u64::from(height);
        let points = buffer("soft points", 4 * WORDS * most, wgpu::BufferUsages::COPY_DST);
        let uniform = bindings::uniform(device, "soft", size_of::<SoftUniform>());
        let buffers = [&uniform, &points].map(wgpu::Buffer::as_entire_binding);
        Self {
            size,
            position: texture("soft positions", POSITION),
            normal: texture("soft normals", NORMAL),
            depth: texture("soft depth", DEPTH_FORMAT),
            group: device.group("soft", &points_layout(device), &buffers),
            asked: buffer("asked points", 8 * most, wgpu::BufferUsages::empty()),
            count: buffer(
                "count of asked points",
                16,
                wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
            ),
            uniform,
            points,
            zones: Mutex::default(),
        }
    }

    /// Pixels of a target `ssaa` times as fine as `camera`'s picture along each edge of a point's square.
    fn across(camera: &Camera, ssaa: u32, focus: &Sphere) -> u32 {
        let away = (camera.projection * camera.view * focus.center.extend(1.0)).w;
        let pixel = camera.pixel() / ssaa as f32 * away.abs();
        (SPACING / pixel.max(1e-9)).round().clamp(ACROSS[0] as f32, ACROSS[1] as f32) as u32
    }

    /// Records them for `bodies`.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        canvas: &mut Canvas<'_, '_>,
        bodies: &[&Body],
    ) -> Result<()> {
        let across = Self::across(canvas.camera, canvas.targets.ssaa, canvas.focus);
        let [wide, high] = self.size.map(|side| side.div_ceil(across));
        let uniform = SoftUniform { across, wide, high, zone: 0, first: [0; 2], size: [wide, high] };
        canvas.commands.context().queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));

        let surface = pipelines.surface(&canvas.commands.context().device)?;
        let strays: Vec<_> = bodies.iter().map(|body| canvas.stray(body).max(STRAY)).collect();
        let depth = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard };
        let mut pass = canvas.commands.render(
            "body",
            &[cleared(&self.position), cleared(&self.normal)],
            deep(&self.depth, Some(depth)),
        );
        // The middle of a point's pixel is that of its square, also where the last squares reach beyond the picture.
        let [width, height] = self.size.map(|side| side as f32 / across as f32);
        pass.set_viewport([0.0; 2], [width, height]);
        pass.set_pipeline(&surface);
        pass.set_bind_group(0, canvas.frame, &[]);
        canvas_parts(&mut pass, canvas.parts, |pass, i| bodies[i].record(pass, strays[i]));
        drop(pass);
        if canvas.parts.iter().any(|part| part.number > 0) {
            return self.record_zones(pipelines, canvas, bodies, uniform);
        }

        canvas.commands.context().queue.write_buffer(&self.count, 0, bytemuck::bytes_of(&NONE_ASKED));
        let light = canvas.light;
        self.ask(pipelines, canvas, (light, &self.uniform, &self.count), wide * high)
    }

    /// Lists and asks the points of one zone after the other: where its bodies can be, in its light.
    fn record_zones(
        &self,
        pipelines: &Pipelines,
        canvas: &mut Canvas<'_, '_>,
        bodies: &[&Body],
        whole: SoftUniform,
    ) -> Result<()> {
        canvas.commands.clear(&self.points, None);
        let parts = canvas.parts;
        // What a panic leaves behind is whole.
        let mut zones = self.zones.lock().unwrap_or_else(PoisonError::into_inner);
        while zones.len() < parts.len() {
            // The uniform, and how many points are asked.
            zones.push(canvas.commands.context().device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("soft zone"),
                size: COUNT_AT + 16,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }));
        }
        for (part, buffer) in parts.iter().zip(zones.iter()) {
            let corners = part.bodies.iter().flat_map(|i| bodies[*i].corners());
            let Some((first, size)) = square(canvas.camera, corners, [whole.wide, whole.high]) else {
                continue;
            };
            let uniform = SoftUniform { zone: part.number, first, size, ..whole };
            canvas.commands.context().queue.write_buffer(buffer, 0, bytemuck::bytes_of(&uniform));
            canvas.commands.context().queue.write_buffer(buffer, COUNT_AT, bytemuck::bytes_of(&NONE_ASKED));
            canvas.commands.encoder().copy_buffer_to_buffer(buffer, COUNT_AT, &self.count, 0, 16);
            self.ask(pipelines, canvas, (part.light, buffer, &self.count), size[0] * size[1])?;
        }
        Ok(())
    }

    /// Looks at so many points, and asks `light` for those that see a body.
    fn ask(
        &self,
        pipelines: &Pipelines,
        canvas: &mut Canvas<'_, '_>,
        (light, uniform, count): (&light::State, &wgpu::Buffer, &wgpu::Buffer),
        looked_at: u32,
    ) -> Result<()> {
        let all = wgpu::Buffer::as_entire_binding;
        let [position, normal] = [&self.position, &self.normal].map(wgpu::BindingResource::TextureView);
        let soft = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: uniform,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<SoftUniform>() as u64),
        });
        let (points, asked, counted) = (all(&self.points), all(&self.asked), all(count));
        let listed = [position.clone(), soft.clone(), points.clone(), asked.clone(), counted.clone()];
        let listed = pipelines.list.bind(&listed);
        let light = light.frame_resources(canvas.eye);
        let lit = [&light[..], &[position, normal, soft, points, asked, counted]].concat();
        let lit = pipelines.ask.bind(&lit);
        let mut pass = canvas.commands.compute("body");
        pipelines.list.record(&mut pass, &listed, &[], looked_at.div_ceil(STRAND_WORKGROUP));
        pipelines.ask.record_indirect(&mut pass, &lit, &[], (count, 0));
        pass.end()
    }
}

/// The first column and row of a picture of `size` in which a box with these corners can be seen, and how many; none
/// where it cannot.
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
        let place = Vec2::new(at.x, -at.y) / at.w.max(1e-3) * 0.5 + 0.5;
        (low, high) = (low.min(place), high.max(place));
    }
    if behind {
        (low, high) = (Vec2::ZERO, Vec2::ONE);
    }
    // A point beside what is seen is asked too.
    let extent = UVec2::from(size).as_vec2();
    let low = (low * extent - 2.0).max(Vec2::ZERO).floor().min(extent).as_uvec2();
    let high = (high * extent + 2.0).max(Vec2::ZERO).ceil().min(extent).as_uvec2();
    (any && low.cmplt(high).all()).then(|| (low.into(), (high - low).into()))
}
