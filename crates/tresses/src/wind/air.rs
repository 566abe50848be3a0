//! The air around one groom: its grid, and how the grid follows the head.

use super::{
    blocks, drag,
    grids::{Advection, Grids},
    gusts::Gusts,
    levels,
    params::{Wind, WindUniforms},
    pipelines::{Dispatch, Pipelines, PressureSolve},
};
use crate::{
    Context, Error, Pose, Result,
    clock::{MAX_STEPS, Mode, Step, Steps},
    collide::ColliderSet,
    gpu::Uniform,
    space::Field,
};
use bytemuck::Zeroable;
use glam::{DVec3, I64Vec3, IVec3, Vec3};
use std::sync::Arc;

/// Stride between the uniforms of consecutive steps, bytes: a multiple of every adapter's alignment.
const STRIDE: u64 = 1280;
/// Hairs in a cell have all directions: the mean of the cubed sine of their angle to the flow.
const ACROSS: f32 = 3.0 * std::f32::consts::PI / 16.0;

/// Position of a step's air grid. The texture coordinate of `x` is `(x - corner) * scale`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AirGrid {
    /// Corner of the grid, meters, relative to the origin of the simulation (by default the world's origin).
    pub corner: Vec3,
    /// Texture coordinates per meter.
    pub scale: f32,
}

/// Position of the hair's grid, for the fluid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HairGrid {
    /// Texture coordinate of the head's origin.
    pub bias: Vec3,
    /// Texture coordinates per meter, in the head's axes.
    pub scale: f32,
}

/// The air around one groom, on the GPU.
#[derive(Debug)]
pub(crate) struct Air {
    pipelines: Arc<Pipelines>,
    /// Cells along an axis.
    pub cells: u32,
    /// Edge of a cell, meters.
    pub cell: f32,
    /// Velocity of the air at the centers of cells, m/s (xyz), rgba16float.
    pub view: wgpu::TextureView,
    /// Velocity times a weight that grows with the hair in the cell (xyz), and that weight, 0 to 1 (w).
    pub among: wgpu::TextureView,
    /// Velocity on the three lower faces of each cell, m/s (xyz), rgba16float. The last cells along an axis have no
    /// upper face and count as outside.
    #[cfg(test)]
    pub faces: wgpu::Texture,
    /// Response of each of these faces to a pressure difference, 0 to 1 (xyz), rgba16float.
    #[cfg(test)]
    pub give: wgpu::Texture,
    /// Advects the air without MacCormack's correction, for comparison.
    pub plain: bool,
    advection: Advection,
    pressure: PressureSolve,
    center: Vec3,
    uniforms: Uniform,
    bytes: u64,
    /// The wind for which `gusts` was created.
    wind: Option<Wind>,
    gusts: Gusts,
    /// Corner of the grid in whole cells, and the origin from which they are counted, meters.
    corner: I64Vec3,
    zero: DVec3,
    /// Distance that the wind has traveled, meters.
    travel: DVec3,
    started: bool,
    /// Settings of each step of the frame.
    runs: Vec<Run>,
}

impl Air {
    /// Creates air at rest in a cube of edge `size` (meters) with `cells` cells along each axis around `center`, a
    /// point of the head (groom space). `hair_grid` has the hair's mean velocity (xyz, m/s) and length per volume (w,
    /// km/m³).
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(
        context: &Context,
        cells: u32,
        (center, size): (Vec3, f32),
        hair_grid: &wgpu::TextureView,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let max_size = device.limits().max_texture_dimension_3d;
        if cells + 2 > max_size {
            return Err(Error::Limit {
                what: "the air",
                need: (cells + 2).into(),
                have: max_size.into(),
                unit: "cells along an axis",
            });
        }
        let uniforms = device.storage_uniform(STRIDE as usize * (MAX_STEPS * MAX_SPLIT) as usize);
        let grids = Grids::new(device, cells);
        let advection = grids.advection(&pipelines, &uniforms, hair_grid, cells);
        let pressure = if context.tier().software {
            blocks::solve(context, &pipelines, &uniforms, &grids, cells)
        } else {
            levels::solve(context, &pipelines, &grids, cells)
        };
        Ok(Self {
            pipelines,
            cells,
            cell: size / cells as f32,
            view: grids.center,
            among: grids.among,
            #[cfg(test)]
            faces: grids.faces.texture().clone(),
            #[cfg(test)]
            give: grids.give.texture().clone(),
            plain: false,
            bytes: grids.bytes + pressure.bytes + uniforms.size(),
            advection,
            pressure,
            center,
            uniforms,
            wind: None,
            gusts: Gusts::default(),
            corner: I64Vec3::ZERO,
            zero: DVec3::ZERO,
            travel: DVec3::ZERO,
            started: false,
            runs: Vec::new(),
        })
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the mean velocity of the wind for which the last steps were prepared, world axes, m/s.
    #[cfg(feature = "debug-views")]
    pub(crate) fn mean(&self) -> Vec3 {
        self.wind.map_or(Vec3::ZERO, |wind| wind.velocity)
    }

    /// Restarts the air undisturbed at the next step.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// Writes the uniforms of the steps of `frame`, at most the last [`MAX_STEPS`], for `wind`; poses are in world
    /// space. `diameter` is a hair's diameter, meters. `hair` is the hair's grid; without it the fluid contains no
    /// hair.
    #[cfg(test)]
    pub fn prepare(&mut self, wind: &Wind, diameter: f32, frame: &Steps<'_>, hair: Option<HairGrid>) {
        self.prepare_in(wind, diameter, frame, &[], hair);
    }

    /// Like [`prepare`](Self::prepare), for hair simulated in a carrier frame: `fields` holds the air's velocity there
    /// for each step.
    pub(crate) fn prepare_in(
        &mut self,
        wind: &Wind,
        diameter: f32,
        frame: &Steps<'_>,
        fields: &[Field],
        hair: Option<HairGrid>,
    ) {
        let shape = |w: &Wind| (w.gusts == 0.0, w.gust_length, w.seed);
        if self.wind.as_ref().map(shape) != Some(shape(wind)) {
            self.gusts = Gusts::new(wind, self.cell);
        }
        self.wind = Some(*wind);
        self.runs.clear();
        let steps = frame.last();
        let mut bytes = Vec::with_capacity(steps.len() * STRIDE as usize);
        for (i, step) in steps.iter().enumerate() {
            let first = (bytes.len() / STRIDE as usize) as u32;
            let field = fields.get(i).copied().unwrap_or(Field::of(Vec3::ZERO, wind.velocity));
            let parts = self.parts(wind, field.wind, frame.length);
            let mut uniforms = self.step(&field, step, hair);
            uniforms.moment = (i as u32 + 1) * frame.substeps;
            uniforms.reynolds = diameter / drag::AIR_VISCOSITY;
            self.runs.push(Run { first, parts, fresh: uniforms.reset == 1, grid: self.grid() });
            for _ in 0..parts {
                let length = frame.length / parts as f32;
                uniforms.drag = length * 0.5 * diameter * ACROSS * 1e3;
                self.blow(wind, &field, &mut uniforms, length);
                bytes.extend_from_slice(bytemuck::bytes_of(&uniforms));
                bytes.resize(bytes.len().next_multiple_of(STRIDE as usize), 0);
                (uniforms.reset, uniforms.shift, uniforms.kick) = (0, IVec3::ZERO, Vec3::ZERO);
            }
        }
        self.uniforms.write(0, &bytes);
    }

    /// Returns the position of the grid after step `index` of the last frame with steps.
    pub fn grid_after(&self, index: u32) -> AirGrid {
        self.runs.get(index as usize).map(|run| run.grid).unwrap_or_default()
    }

    /// Returns the position of the grid after the most recent step.
    #[cfg(feature = "debug-views")]
    pub(crate) fn current_grid(&self) -> AirGrid {
        self.grid()
    }

    /// Records step `index` of those written by [`prepare`](Self::prepare). The caller has
    /// [advanced](ColliderSet::advance) `colliders` by the same steps.
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, colliders: &ColliderSet, index: u32) {
        let run = self.runs[index as usize];
        pass.set_bind_group(1, colliders.group(), &[]);
        for part in 0..run.parts {
            let offset = (run.first + part) * STRIDE as u32;
            for dispatch in self.dispatches(part == 0, run.fresh) {
                dispatch.record(pass, &self.pipelines, offset);
            }
        }
    }

    /// Returns the dispatches of a part of a step, the `first` one or another. In a `fresh` step the air starts anew.
    pub(crate) fn dispatches(&self, first: bool, fresh: bool) -> impl Iterator<Item = &Dispatch> {
        let obstacles = first.then_some(&self.advection.obstacles);
        let pressure = if first && fresh { &self.pressure.fresh } else { &self.pressure.steady };
        obstacles.into_iter().chain(&self.advection.air).chain(pressure)
    }

    fn grid(&self) -> AirGrid {
        let corner = self.edge().as_vec3();
        AirGrid { corner, scale: 1.0 / (self.cells as f32 * self.cell) }
    }

    /// Returns the grid's corner, meters.
    fn edge(&self) -> DVec3 {
        self.corner.as_dvec3() * f64::from(self.cell) + self.zero
    }

    /// Moves the grid by `offset` meters, when the origin of the simulation moves.
    pub(crate) fn shift(&mut self, offset: Vec3) {
        self.zero += offset.as_dvec3();
    }

    /// Returns the number of parts into which a step is split, so that air does not jump over a head.
    fn parts(&self, wind: &Wind, mean: Vec3, step: f32) -> u32 {
        let distance = mean.length() * (1.0 + wind.gusts) * step;
        let cells = distance / self.cell;
        let parts = (distance / MAX_TRAVEL).min(cells / COARSE_TRAVEL_CELLS).max(cells / MAX_TRAVEL_CELLS);
        (parts.ceil() as u32).clamp(1, MAX_SPLIT)
    }

    /// Advances the wind by `dt` seconds, and writes advection scale and gusts to the uniforms.
    fn blow(&mut self, wind: &Wind, field: &Field, u: &mut WindUniforms, dt: f32) {
        if u.reset == 0 {
            self.travel += field.own.as_dvec3() * f64::from(dt);
        }
        u.advection_scale = dt / self.cell;
        // Gusts are fixed to the air's own ground, over which the grid may move.
        let deviation = f64::from(wind.gusts * field.own.length());
        let gusts = self.gusts.at(self.edge() + field.at, self.travel, deviation, self.cell);
        u.gust_count = gusts.len() as u32;
        u.gusts[..gusts.len()].copy_from_slice(&gusts);
    }

    /// Returns the uniforms of one step, and moves the grid to the head's position at its end.
    fn step(&mut self, field: &Field, step: &Step, hair: Option<HairGrid>) -> WindUniforms {
        let cell = f64::from(self.cell);
        // Move by whole cells, so that a moving head causes no interpolation.
        let exact_corner =
            (step.end.point(self.center).as_dvec3() - self.zero) / cell - 0.5 * f64::from(self.cells);
        let corner = exact_corner.round().as_i64vec3();
        let reset = !self.started || step.mode == Mode::Reset;
        // The hair's grid is not written by a step that resets hair: it holds earlier hair, or the hair of another head.
        let hair = hair.filter(|_| !reset);
        // Teleported hair keeps its air.
        let corner_shift =
            if reset || step.mode == Mode::Rigid { I64Vec3::ZERO } else { corner - self.corner };
        self.started = true;
        self.corner = corner;
        if reset {
            self.travel = DVec3::ZERO;
        }
        let at = self.edge();
        let local = |pose: &Pose| (pose.translation.as_dvec3() - at).as_vec3();
        WindUniforms {
            mean: field.wind,
            kick: field.kick,
            cells: self.cells,
            shift: corner_shift
                .as_ivec3()
                .clamp(IVec3::splat(-4 * self.cells as i32), IVec3::splat(4 * self.cells as i32)),
            head: step.begin.rotation.into(),
            head_at: local(&step.begin),
            cell: self.cell,
            corner: at.as_vec3(),
            reset: u32::from(reset),
            inflow: inflow(field.wind),
            hair_bias: hair.map_or(Vec3::splat(-1.0), |hair| hair.bias),
            hair_scale: hair.map_or(0.0, |hair| hair.scale),
            one: 1,
            plain: u32::from(self.plain),
            ..Zeroable::zeroed()
        }
    }
}

/// Largest distance that the air travels at once, meters: about a head's width.
const MAX_TRAVEL: f32 = 0.21;
/// Number of cells that the air may always travel at once: coarse grids do not resolve a head.
const COARSE_TRAVEL_CELLS: f32 = 6.0;
/// Largest number of cells that the air travels at once, so that the pressure can follow.
const MAX_TRAVEL_CELLS: f32 = 8.0;
/// Maximum number of parts of a step.
const MAX_SPLIT: u32 = 4;

/// Settings of one step of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// Slot of its first uniforms.
    pub first: u32,
    /// Number of parts, each with its own uniforms.
    pub parts: u32,
    /// Whether the air starts anew.
    pub fresh: bool,
    /// Position of the grid.
    grid: AirGrid,
}

/// Returns the sides through which wind of mean velocity `mean` enters: those that it meets at more than 6 degrees. The
/// others are open.
fn inflow(mean: Vec3) -> u32 {
    let min_speed = 0.1 * mean.length();
    (0..3)
        .map(|axis| {
            let lower = u32::from(mean[axis] > min_speed) << (2 * axis);
            lower | u32::from(mean[axis] < -min_speed) << (2 * axis + 1)
        })
        .sum()
}
