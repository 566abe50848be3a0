//! The air around one groom: its grid, and how the grid follows the head.

use super::{
    gusts::Gusts,
    params::{Wind, WindUniforms},
    stage::Fluid,
};
use crate::{
    Pose, Result,
    gpu::bindings::uniform,
    simulate::{MAX_STEPS, Mode, SdfCollider, SimulationParams, Step, drag},
    strands::buffers::storage,
};
use bytemuck::Zeroable;
use glam::{DVec3, I64Vec3, Vec3};

/// Bytes from one step's uniforms to the next's: a multiple of every adapter's alignment.
const STRIDE: u64 = 1280;
/// The same for the halves of a sweep.
const HALF_STRIDE: u64 = 256;
/// Hairs in a cell lie in all directions: the mean of the cubed sine of their angle to the air.
const ACROSS: f32 = 3.0 * std::f32::consts::PI / 16.0;

/// Where in the world a step's air lies: texture coordinate `(x - corner) * scale`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirPlace {
    /// The grid's corner, world space, metres.
    pub corner: Vec3,
    /// Texture coordinates per metre.
    pub scale: f32,
}

/// The hair's grid as the fluid reads it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HairGrid {
    /// Texture coordinate of the head's origin.
    pub bias: Vec3,
    /// Texture coordinates per metre, in the head's axes.
    pub scale: f32,
}

#[derive(Debug)]
pub(super) struct Groups {
    pub obstacles: wgpu::BindGroup,
    pub predict: wgpu::BindGroup,
    pub correct: wgpu::BindGroup,
    pub divergence: wgpu::BindGroup,
    pub relax: wgpu::BindGroup,
    pub project: wgpu::BindGroup,
}

/// The air around one groom, on the GPU.
#[derive(Debug)]
pub struct Air {
    /// Cells along an axis.
    pub cells: u32,
    /// Edge of a cell, metres.
    pub cell: f32,
    /// Velocity of the air in m/s at the centres of cells (xyz), rgba16float.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
    /// Velocity on the faces after the last step, m/s: one axis after the other, each with
    /// (`cells` + 2)³ values. The lower faces of cell (x, y, z) stand at (x + 1, y + 1, z + 1).
    pub faces: wgpu::Buffer,
    /// How much a pressure difference acts on each of the faces, 0 to 1.
    pub give: wgpu::Buffer,
    /// What would flow out of each cell without pressure, m/s.
    pub source: wgpu::Buffer,
    pub(super) groups: Groups,
    center: Vec3,
    field: (Vec3, Vec3),
    uniforms: wgpu::Buffer,
    buffer_bytes: u64,
    /// The wind that `gusts` was made for.
    wind: Option<Wind>,
    gusts: Gusts,
    /// The corner of the grid in whole cells from the world's origin.
    corner: I64Vec3,
    /// How far the wind has blown, metres.
    way: DVec3,
    started: bool,
    sweeps: Vec<u32>,
    places: Vec<AirPlace>,
}

impl Air {
    /// Air at rest in a cube of edge `size` (metres) with `cells` cells along each axis around
    /// `center`, a point of the head (groom space). `field` is the head's distance field; `hair`
    /// the hair's length per volume (w, km/m³) and mean velocity (xyz, m/s).
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        fluid: &Fluid,
        cells: u32,
        (center, size): (Vec3, f32),
        field: &SdfCollider,
        hair: &wgpu::TextureView,
    ) -> Result<Self> {
        let count = u64::from(cells + 2).pow(3);
        let faces = |what| storage::<[f32; 3]>(device, what, count);
        let scalars = |what| storage::<f32>(device, what, count);
        let vectors = |what| storage::<[f32; 4]>(device, what, count);
        let (now, carried, before, give) =
            (faces("air")?, faces("air carried")?, faces("air before pressure")?, faces("air give")?);
        let (source, pressure, last) =
            (scalars("air source")?, scalars("air pressure")?, scalars("air last pressure")?);
        let (middle, solid, hairs) = (vectors("air centres")?, vectors("air solid")?, vectors("air hair")?);
        let uniforms = uniform(device, "air steps", STRIDE as usize * MAX_STEPS as usize);
        let halves = uniform(device, "air halves", 2 * HALF_STRIDE as usize);
        queue.write_buffer(&halves, HALF_STRIDE, &1u32.to_le_bytes());
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("air"),
            size: wgpu::Extent3d { width: cells, height: cells, depth_or_array_layers: cells },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let dynamic = |buffer, size: usize| {
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset: 0,
                size: wgpu::BufferSize::new(size as u64),
            })
        };
        let step = || dynamic(&uniforms, size_of::<WindUniforms>());
        let all = wgpu::Buffer::as_entire_binding;
        let texel = wgpu::BindingResource::TextureView;
        let groups = Groups {
            obstacles: fluid.obstacles.bind(
                device,
                &[
                    step(),
                    texel(&field.view),
                    texel(hair),
                    wgpu::BindingResource::Sampler(&fluid.sampler),
                    all(&solid),
                    all(&hairs),
                ],
            ),
            predict: fluid.predict.bind(device, &[step(), all(&now), all(&middle), all(&carried)]),
            correct: fluid.correct.bind(
                device,
                &[
                    step(),
                    all(&now),
                    all(&middle),
                    all(&carried),
                    all(&solid),
                    all(&hairs),
                    all(&before),
                    all(&give),
                ],
            ),
            divergence: fluid
                .divergence
                .bind(device, &[step(), all(&before), all(&last), all(&source), all(&pressure)]),
            relax: fluid
                .relax
                .bind(device, &[step(), dynamic(&halves, 16), all(&give), all(&source), all(&pressure)]),
            project: fluid.project.bind(
                device,
                &[
                    step(),
                    all(&before),
                    all(&give),
                    all(&pressure),
                    all(&last),
                    all(&now),
                    all(&middle),
                    texel(&view),
                ],
            ),
        };
        let buffers = [&now, &carried, &before, &give, &source, &pressure, &last, &middle, &solid, &hairs];
        Ok(Self {
            cells,
            cell: size / cells as f32,
            buffer_bytes: buffers.iter().map(|b| b.size()).sum::<u64>() + uniforms.size() + halves.size(),
            texture,
            view,
            faces: now,
            give,
            source,
            groups,
            center,
            field: (field.bias, field.scale),
            uniforms,
            wind: None,
            gusts: Gusts::default(),
            corner: I64Vec3::ZERO,
            way: DVec3::ZERO,
            started: false,
            sweeps: Vec::new(),
            places: Vec::new(),
        })
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffer_bytes + u64::from(self.cells).pow(3) * 8
    }

    /// The air starts anew at the next step.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// Writes the uniforms of a frame's `steps`. `field` is the pose of the distance field relative
    /// to the head, where there is one; `hair` the hair's grid, without which no hair is in the way.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        physics: &SimulationParams,
        steps: &[Step],
        field: Option<Pose>,
        hair: Option<HairGrid>,
    ) {
        let wind = &physics.wind;
        let shape = |w: &Wind| (w.turbulence == 0.0, w.gust_length, w.seed);
        if self.wind.as_ref().map(shape) != Some(shape(wind)) {
            self.gusts = Gusts::new(wind, self.cell);
        }
        self.wind = Some(*wind);
        let mut bytes = vec![0u8; STRIDE as usize * steps.len()];
        self.places.clear();
        self.sweeps.clear();
        for (step, slot) in steps.iter().zip(bytes.as_chunks_mut::<{ STRIDE as usize }>().0) {
            let uniforms = self.step(physics, step, field, hair);
            slot[..size_of::<WindUniforms>()].copy_from_slice(bytemuck::bytes_of(&uniforms));
        }
        queue.write_buffer(&self.uniforms, 0, &bytes);
    }

    /// Where the air lies after step `index` of the last frame that had steps.
    pub fn place(&self, index: usize) -> AirPlace {
        self.places.get(index).copied().unwrap_or_default()
    }

    pub(super) fn offset(&self, index: usize) -> u32 {
        index as u32 * STRIDE as u32
    }

    pub(super) fn parity(&self, half: u32) -> u32 {
        half * HALF_STRIDE as u32
    }

    pub(super) fn sweeps(&self, index: usize) -> u32 {
        self.sweeps[index]
    }

    /// The uniforms of one step; the grid moves to where the head is at its end.
    fn step(
        &mut self,
        physics: &SimulationParams,
        step: &Step,
        field: Option<Pose>,
        hair: Option<HairGrid>,
    ) -> WindUniforms {
        let wind = &physics.wind;
        let cell = f64::from(self.cell);
        // By whole cells, so that nothing is interpolated because the head moves.
        let middle = step.end.point(self.center).as_dvec3() / cell - 0.5 * f64::from(self.cells);
        let corner = middle.round().as_i64vec3();
        let reset = !self.started || step.mode == Mode::Reset;
        // Teleported hair takes its air along.
        let moved = if reset || step.mode == Mode::Carry { I64Vec3::ZERO } else { corner - self.corner };
        self.started = true;
        self.corner = corner;
        let dt = physics.step;
        self.way = if reset { DVec3::ZERO } else { self.way + wind.velocity.as_dvec3() * f64::from(dt) };
        let at = corner.as_dvec3() * cell;
        self.places.push(AirPlace { corner: at.as_vec3(), scale: 1.0 / (self.cells as f32 * self.cell) });
        let speed = wind.velocity.length();
        self.sweeps.push(sweeps(self.cells) * if reset { 4 } else { 1 });
        let deviation = f64::from(wind.turbulence * speed);
        let local = |pose: &Pose| (pose.translation.as_dvec3() - at).as_vec3();
        let own = |head: &Pose| field.map_or(*head, |own| head.after(&own));
        let (end, begin) = (own(&step.end), own(&step.begin));
        let mut u = WindUniforms {
            mean: wind.velocity,
            cells: self.cells,
            shift: moved
                .as_ivec3()
                .clamp(glam::IVec3::splat(-4 * self.cells as i32), glam::IVec3::splat(4 * self.cells as i32)),
            reach: dt / self.cell,
            head: step.begin.rotation.into(),
            field: end.rotation.into(),
            field_before: begin.rotation.into(),
            head_at: local(&step.begin),
            cell: self.cell,
            field_at: local(&end),
            has_field: u32::from(field.is_some()),
            field_before_at: local(&begin),
            per_second: if step.mode == Mode::Step { 1.0 / dt } else { 0.0 },
            field_bias: self.field.0,
            reset: u32::from(reset),
            field_scale: self.field.1,
            inflow: inflow(wind.velocity),
            hair_bias: hair.map_or(Vec3::splat(-1.0), |hair| hair.bias),
            hair_scale: hair.map_or(0.0, |hair| hair.scale),
            drag: dt * 0.5 * physics.diameter * ACROSS * 1e3,
            reynolds: physics.diameter / drag::AIR_VISCOSITY,
            relaxation: OVER_RELAXATION,
            one: 1,
            ..Zeroable::zeroed()
        };
        let gusts = self.gusts.at(at, self.way, deviation, self.cell);
        u.gust_count = gusts.len() as u32;
        u.gusts[..gusts.len()].copy_from_slice(&gusts);
        u
    }
}

/// Over-relaxation of the pressure's sweeps.
const OVER_RELAXATION: f32 = 1.7;

/// Sweeps of a step: information must cross the grid.
fn sweeps(cells: u32) -> u32 {
    (cells * 12).div_ceil(32).max(6)
}

/// The sides through which wind of mean velocity `mean` enters: those that it meets at more than
/// 6 degrees; the others are open.
fn inflow(mean: Vec3) -> u32 {
    let least = 0.1 * mean.length();
    (0..3)
        .map(|axis| {
            let lower = u32::from(mean[axis] > least) << (2 * axis);
            lower | u32::from(mean[axis] < -least) << (2 * axis + 1)
        })
        .sum()
}
