//! Hair takes up room: one grid of density and velocity around the head, from the guides.
//!
//! What (S6, S7): before each fixed step the hair of the guide vertices, weighted by the strands that they
//! stand for, goes into a cube of cells that moves with the head. Where hair is denser than it
//! is at rest, it is pushed along the negative gradient of the excess; everywhere it is rubbed
//! towards the mean velocity of the hair around it (Petrovic, Henne and Anderson 2005). For
//! comparison (S9) there is the push of fixed magnitude between neighbouring cells (Bertails, Ménier
//! and Cani 2005).
//!
//! How: `splat` adds integers, which need no order to give the same bits; `sum`, `blur` and
//! `density` blur along one axis each, a thread per line of cells; `push` takes the gradient.
//! `simulate::forces` then samples the two textures at every guide vertex. `obstacles` runs only when
//! something has moved relative to the head; the head's own field has not.
//!
//! ```text
//! guide state ─► splat ─► cells (i32 × 8) ─► sum ─► blur ─► density ─► hair (rgba16float: mean velocity, density)
//! colliders ───► obstacles ──────────────────┘              ▲  └─► excess ─► push (rgba16float: acceleration)
//!                                            rest density ──┘
//! ```
//!
//! **Blur.** Recursive averages, twice forth and twice back, have a cost that does not depend on their
//! width: at 64³ a blur of the same metres costs per cell what it costs at 32³. A kernel with as many taps as
//! the width asks for took three times as long at 32³ and twelve times at 64³ on a CPU driver.
//!
//! **Compared with rest.** The density that hair may have at a place is what the rest pose has at
//! that place *of the head*, or what the hair that is there has where it rests, whichever is more. So
//! a style at rest feels nothing, whatever its density, and a lock that swings as a whole is not blown up.
//! The first step after a reset splats the rest pose with the obstacles as they are then.
//!
//! **Pressure.** With the excess `e = max(ρ - (1 + τ) ρ₀, 0)` the acceleration is `-c² ∇e / ρ`: the
//! pressure of a fluid with the speed of sound `c`, which only pushes. Blur and `c` are in metres and
//! metres per second, so that the force does not depend on the resolution.
//!
//! **Obstacles** take room from the hair: the density is that in the part of a cell's surroundings that they leave free.
//!
//! **Friction** is what one sees most: without it neighbouring locks part in a shake and swing on for
//! seconds. It goes towards the mean velocity of the surroundings, so a swing of all hair is not slowed.
//!
//! **Cost.** Most of it is the splat: 40 atomic additions per guide vertex. Grooms of more than
//! [`VolumeOptions::most_splatted`] vertices splat every second, third, ... guide with its share of the hair.
//!
//! **Known limits.** What leaves the grid is not counted and feels nothing. The push cannot see
//! strands within a cell: locks of one cell may interleave.
//!
//! **Why not a pressure solve?** An incompressible projection would hold the volume exactly but
//! also where hair is thin, and costs tens of passes. The excess is sparse and small.
//!
//! **Untried:** FLIP-like transfer of velocity differences (McAdams 2009); anisotropic friction;
//! a grid that follows the hair's bounds.

mod grid;
pub mod params;

#[cfg(test)]
mod gpu_tests;
#[cfg(test)]
mod reference;

use crate::{
    Error, Pose, Result,
    collide::{self, ColliderSet},
    constants::{GUIDE_WORKGROUP, VOLUME_WORKGROUP},
    gpu::{Binding, Kernel, bindings},
    simulate::{MAX_STEPS, RestGuides, SimulationParams, Step, params::Mode},
    strands::{GuideBuffers, buffers::storage},
};
use glam::Vec3;
use params::{VolumeUniforms, gain};

pub use grid::Grid;
pub use params::{HairHair, HairHairMode};

/// Bytes from one step's uniforms to the next's: a multiple of every adapter's alignment.
const STRIDE: u32 = 512;
/// The slot of the uniforms of the rest pose, after those of a frame's steps.
const RESTING: u32 = MAX_STEPS;
/// Integers per cell, as in the shaders.
const CHANNELS: u64 = 8;
/// What all hair together weighs in the integers of the splat.
const TOTAL_UNITS: f64 = (1u64 << 30) as f64;

/// The pipelines of the stage.
#[derive(Debug)]
pub struct VolumeStage {
    obstacles: Kernel,
    splat: Kernel,
    sum: Kernel,
    blur: Kernel,
    density: Kernel,
    push: Kernel,
    settle: Kernel,
}

impl VolumeStage {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        use Binding::{Storage as Read, StorageMut as Write, UniformDynamic as Uniform, Write3d};
        let kernel = |name, entries: &[Binding]| Kernel::new(device, name, entries);
        let colliders = collide::layout(device);
        Self {
            obstacles: Kernel::beside(device, "volume::obstacles", &[Uniform, Write], &[&colliders]),
            splat: kernel("volume::splat", &[Uniform, Read, Read, Read, Read, Read, Write]),
            sum: kernel("volume::sum", &[Uniform, Write, Read, Write]),
            blur: kernel("volume::blur", &[Uniform, Write]),
            density: kernel("volume::density", &[Uniform, Write, Write, Write, Write, Write3d]),
            push: kernel("volume::push", &[Uniform, Read, Read, Write3d]),
            settle: kernel("volume::settle", &[Uniform, Read, Read, Write]),
        }
    }
}

/// The size of a groom's grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VolumeOptions {
    /// Cells along each axis, 8 to 96.
    pub resolution: u32,
    /// The most guide vertices that are splatted in a step; of more, every second guide counts twice,
    /// and so on.
    pub most_splatted: u32,
}

impl Default for VolumeOptions {
    fn default() -> Self {
        Self { resolution: 32, most_splatted: 8_192 }
    }
}

/// The grid of one groom.
#[derive(Debug)]
pub struct Volume {
    /// Where it is.
    pub grid: Grid,
    /// The texture behind [`hair`](Self::hair).
    pub hair_texture: wgpu::Texture,
    /// Mean velocity of hair (xyz, m/s, world axes) and its length per volume (w, km/m³), 3-D, rgba16float.
    pub hair: wgpu::TextureView,
    /// The texture behind [`push`](Self::push).
    pub push_texture: wgpu::Texture,
    /// What the excess of density does to hair: acceleration (xyz, m/s², axes of the head), 3-D, rgba16float.
    pub push: wgpu::TextureView,
    uniforms: wgpu::Buffer,
    cells: wgpu::Buffer,
    obstacles: wgpu::Buffer,
    sums: wgpu::Buffer,
    rest: wgpu::Buffer,
    excess: wgpu::Buffer,
    dense: wgpu::Buffer,
    rested: wgpu::Buffer,
    groups: Groups,
    /// What does not change from step to step.
    base: VolumeUniforms,
    modes: Vec<Mode>,
    /// Whether the obstacles have moved when a step begins, and where relative to the head they were when
    /// they were last put into the grid.
    obstacles_moved: Vec<bool>,
    obstacles_at: Option<Vec<Pose>>,
    /// The blur for which the rest density was computed, if it was, and the one asked for.
    rest_blur: (Option<u32>, u32),
}

#[derive(Debug)]
struct Groups {
    obstacles: wgpu::BindGroup,
    splat: wgpu::BindGroup,
    sum: wgpu::BindGroup,
    blur: wgpu::BindGroup,
    density: wgpu::BindGroup,
    push: wgpu::BindGroup,
    settle: wgpu::BindGroup,
}

impl Volume {
    /// The grid of `guides`, which rest as `rest` says.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a resolution out of its range, [`Error::Limit`] when the adapter
    /// cannot hold the grid.
    pub fn new(
        device: &wgpu::Device,
        stage: &VolumeStage,
        guides: &GuideBuffers,
        rest: &RestGuides,
        options: &VolumeOptions,
    ) -> Result<Self> {
        let VolumeOptions { resolution, most_splatted } = *options;
        if !(8..=96).contains(&resolution) {
            return Err(Error::Parameter {
                name: "grid resolution",
                value: resolution.to_string(),
                range: "from 8 to 96 cells",
            });
        }
        let grid = Grid::around(rest.rest.iter().map(|r| r.position), resolution);
        let n = u64::from(resolution).pow(3);
        let vertices = u64::from(guides.count) * u64::from(guides.vertex_count);
        let texture = |label| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: resolution,
                    height: resolution,
                    depth_or_array_layers: resolution,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D3,
                format: wgpu::TextureFormat::Rgba16Float,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let view = texture.create_view(&Default::default());
            (texture, view)
        };
        let (hair_texture, hair) = texture("volume hair");
        let (push_texture, push) = texture("volume push");
        let uniforms = bindings::uniform(device, "volume steps", (STRIDE * (MAX_STEPS + 1)) as usize);
        let cells = storage::<i32>(device, "volume cells", n * CHANNELS)?;
        let obstacles = storage::<f32>(device, "volume obstacles", n)?;
        let sums = storage::<[f32; 8]>(device, "volume sums", n)?;
        let rest_density = storage::<f32>(device, "volume rest", n)?;
        let excess = storage::<f32>(device, "volume excess", n)?;
        let dense = storage::<f32>(device, "volume density", n)?;
        let rested = storage::<f32>(device, "volume rested", vertices)?;
        let step = || slot(&uniforms);
        let view = wgpu::BindingResource::TextureView;
        let groups = Groups {
            obstacles: stage.obstacles.bind(device, &[step(), obstacles.as_entire_binding()]),
            splat: stage.splat.bind(
                device,
                &[
                    step(),
                    guides.info.as_entire_binding(),
                    guides.rest.as_entire_binding(),
                    guides.current.as_entire_binding(),
                    guides.velocity.as_entire_binding(),
                    rested.as_entire_binding(),
                    cells.as_entire_binding(),
                ],
            ),
            sum: stage.sum.bind(
                device,
                &[step(), cells.as_entire_binding(), obstacles.as_entire_binding(), sums.as_entire_binding()],
            ),
            blur: stage.blur.bind(device, &[step(), sums.as_entire_binding()]),
            density: stage.density.bind(
                device,
                &[
                    step(),
                    sums.as_entire_binding(),
                    rest_density.as_entire_binding(),
                    excess.as_entire_binding(),
                    dense.as_entire_binding(),
                    view(&hair),
                ],
            ),
            push: stage
                .push
                .bind(device, &[step(), excess.as_entire_binding(), dense.as_entire_binding(), view(&push)]),
            settle: stage.settle.bind(
                device,
                &[
                    step(),
                    guides.rest.as_entire_binding(),
                    rest_density.as_entire_binding(),
                    rested.as_entire_binding(),
                ],
            ),
        };
        let base = base(&grid, guides, rest, most_splatted.max(1));
        Ok(Self {
            grid,
            hair_texture,
            hair,
            push_texture,
            push,
            uniforms,
            cells,
            obstacles,
            sums,
            rest: rest_density,
            excess,
            dense,
            rested,
            groups,
            base,
            modes: Vec::new(),
            obstacles_moved: Vec::new(),
            obstacles_at: None,
            rest_blur: (None, 0),
        })
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let buffers = [
            &self.uniforms,
            &self.cells,
            &self.obstacles,
            &self.sums,
            &self.rest,
            &self.excess,
            &self.dense,
            &self.rested,
        ];
        let texels = 2 * 8 * u64::from(self.grid.resolution).pow(3);
        buffers.iter().map(|buffer| buffer.size()).sum::<u64>() + texels
    }

    /// Mean density of the groom, weighted by hair, km/m³.
    pub fn reference(&self) -> f32 {
        self.base.reference
    }

    /// Writes the uniforms of a frame's `steps`, at most [`MAX_STEPS`]. `colliders` have been advanced to
    /// the frame.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        params: &SimulationParams,
        steps: &[Step],
        colliders: &ColliderSet,
    ) {
        let h = params.step;
        let steps = &steps[steps.len().saturating_sub(MAX_STEPS as usize)..];
        self.modes = steps.iter().map(|step| step.mode).collect();
        self.obstacles_moved = (0..steps.len())
            .map(|i| self.obstacles_move(&steps[i].begin, colliders, i * params.substeps as usize))
            .collect();
        let base = self.with(&params.hair_hair, h);
        // The rest density holds for one blur.
        self.rest_blur.1 = base.gain.to_bits();
        let mut bytes = vec![0u8; (STRIDE * (RESTING + 1)) as usize];
        let mut put = |i: usize, uniforms: &VolumeUniforms| {
            let at = i * STRIDE as usize;
            bytes[at..at + size_of::<VolumeUniforms>()].copy_from_slice(bytemuck::bytes_of(uniforms));
        };
        for (i, step) in steps.iter().enumerate() {
            let drift = (step.end.translation - step.begin.translation) / h.max(1e-6);
            let moment = i as u32 * params.substeps;
            put(i, &VolumeUniforms { moment, ..placed(&base, &step.begin, drift) });
        }
        put(RESTING as usize, &VolumeUniforms { resting: 1, ..placed(&base, &Pose::IDENTITY, Vec3::ZERO) });
        queue.write_buffer(&self.uniforms, 0, &bytes);
    }

    /// Records step `i` of those that [`prepare`](Self::prepare) wrote.
    pub fn record(
        &mut self,
        stage: &VolumeStage,
        pass: &mut wgpu::ComputePass<'_>,
        colliders: &ColliderSet,
        i: u32,
    ) {
        let mode = self.modes[i as usize];
        if self.obstacles_moved[i as usize] {
            pass.set_bind_group(1, colliders.group(), &[]);
            let cells = self.grid.resolution.pow(3).div_ceil(VOLUME_WORKGROUP);
            stage.obstacles.record(pass, &self.groups.obstacles, &[Self::offset(i)], cells);
        }
        if mode == Mode::Reset || (mode == Mode::Step && self.rest_blur.0 != Some(self.rest_blur.1)) {
            self.grids(stage, pass, RESTING);
            let vertices = self.base.guide_count * self.base.vertex_count;
            let workgroups = vertices.div_ceil(VOLUME_WORKGROUP);
            stage.settle.record(pass, &self.groups.settle, &[Self::offset(RESTING)], workgroups);
            self.rest_blur.0 = Some(self.rest_blur.1);
        }
        if mode == Mode::Step {
            self.grids(stage, pass, i);
            let cells = self.grid.resolution.pow(3).div_ceil(VOLUME_WORKGROUP);
            stage.push.record(pass, &self.groups.push, &[Self::offset(i)], cells);
        }
    }

    /// Whether any of `colliders` is elsewhere relative to the head (at `head`) at `moment` than when
    /// they were last put into the grid; then they are taken to be put there.
    fn obstacles_move(&mut self, head: &Pose, colliders: &ColliderSet, moment: usize) -> bool {
        let count = colliders.len();
        let poses = colliders.moments().get(moment * count..(moment + 1) * count).unwrap_or_default();
        let back = head.inverse();
        let now: Vec<_> = poses.iter().map(|pose| back.after(pose)).collect();
        let near = |a: &Pose, b: &Pose| {
            a.translation.distance(b.translation) < 0.01 * self.grid.cell
                && (a.rotation.dot(b.rotation).abs() - 1.0).abs() < 1e-6
        };
        let same = self
            .obstacles_at
            .as_ref()
            .is_some_and(|at| at.len() == now.len() && at.iter().zip(&now).all(|(a, b)| near(a, b)));
        if !same {
            self.obstacles_at = Some(now);
        }
        !same
    }

    /// Hair into the grid.
    fn grids(&self, stage: &VolumeStage, pass: &mut wgpu::ComputePass<'_>, slot: u32) {
        let offset = [Self::offset(slot)];
        let lines = self.grid.resolution.pow(2).div_ceil(GUIDE_WORKGROUP);
        let splatted = (self.base.splat_count * self.base.vertex_count).div_ceil(VOLUME_WORKGROUP);
        stage.splat.record(pass, &self.groups.splat, &offset, splatted);
        stage.sum.record(pass, &self.groups.sum, &offset, lines);
        stage.blur.record(pass, &self.groups.blur, &offset, lines);
        stage.density.record(pass, &self.groups.density, &offset, lines);
    }

    /// The uniforms of one step, bound with a dynamic offset.
    pub(crate) fn uniforms(&self) -> wgpu::BindingResource<'_> {
        slot(&self.uniforms)
    }

    /// The dynamic offset of step `i`.
    pub(crate) fn offset(i: u32) -> u32 {
        i * STRIDE
    }

    /// The uniforms with what the user sets.
    fn with(&self, params: &HairHair, h: f32) -> VolumeUniforms {
        let smooth = params.mode != HairHairMode::Fixed;
        let cell = self.base.cell;
        // The splat itself blurs, by a sixth of a cell's square.
        let blur = (params.blur / cell).powi(2) - 1.0 / 6.0;

        let speed = params.speed.min(params.blur.max(cell) / h.max(1e-6));
        VolumeUniforms {
            gain: gain(if smooth { blur } else { 0.0 }),
            mode: params.mode as u32,
            speed_squared: speed * speed,
            tolerance: params.tolerance,
            friction: if smooth { params.friction } else { 0.0 },
            limit: params.limit,
            fixed_push: params.fixed,
            ..self.base
        }
    }
}

/// One step's uniforms.
fn slot(uniforms: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer: uniforms,
        offset: 0,
        size: wgpu::BufferSize::new(size_of::<VolumeUniforms>() as u64),
    })
}

/// What depends on the groom and its grid alone.
fn base(grid: &Grid, guides: &GuideBuffers, rest: &RestGuides, most_splatted: u32) -> VolumeUniforms {
    let vertices = guides.count.saturating_mul(guides.vertex_count);
    let stride = vertices.div_ceil(most_splatted).max(1);
    let metres = |guide: &crate::strands::Guide| {
        let metres = f64::from(guide.strands) * f64::from(guide.length);
        if metres.is_finite() { metres.max(0.0) } else { 0.0 }
    };
    let all: f64 = rest.info.iter().map(metres).sum();
    let splatted: f64 = rest.info.iter().step_by(stride as usize).map(metres).sum();
    let some = splatted > 1e-9;
    let units = if some { TOTAL_UNITS / splatted } else { 0.0 };
    let density = if some { all / TOTAL_UNITS / 1e3 / f64::from(grid.cell).powi(3) } else { 0.0 };
    VolumeUniforms {
        resolution: grid.resolution,
        bias: grid.bias,
        scale: grid.scale,
        cell: grid.cell,
        guide_count: guides.count,
        vertex_count: guides.vertex_count,
        stride,
        splat_count: guides.count.div_ceil(stride),
        units: units as f32,
        density: density as f32,
        reference: grid::mean_density(rest).max(1e-6),
        ..Default::default()
    }
}

/// `base` with the head at `pose`, moving at `drift` (m/s).
fn placed(base: &VolumeUniforms, pose: &Pose, drift: Vec3) -> VolumeUniforms {
    VolumeUniforms { head: pose.rotation.into(), head_at: pose.translation, drift, ..*base }
}
