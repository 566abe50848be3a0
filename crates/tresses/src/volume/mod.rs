//! Hair takes up room: one grid of density and velocity around the head, from the guides.
//!
//! What (S6, S7): before each fixed step the hair of the guide vertices, weighted by the strands that they
//! stand for, goes into a cube of cells that moves with the head. Where hair is denser than it
//! is at rest, it is pushed along the negative gradient of the excess; everywhere it is rubbed
//! towards the mean velocity of the hair around it (Petrovic, Henne and Anderson 2005). For
//! comparison (S9) there is the push of fixed magnitude between neighbouring cells (Bertails, Ménier
//! and Cani 2005).
//!
//! How: `splat` adds integers, which need no order to give the same bits; `sum` makes numbers of them;
//! `blur_x`, `blur_y` and `density` blur along one axis each, a thread for four cells; `push` takes the gradient.
//! `simulate::forces` then samples the two textures at every guide vertex. `obstacles` runs only when
//! something has moved relative to the head; the head's own field has not.
//!
//! ```text
//! guide state ─► splat ─► cells (i32 × 8) ─► sum ─► blur_x ─► blur_y ─► density ─► hair (rgba16float: mean velocity, density)
//! colliders ───► obstacles ──────────────────┘                           ▲  └─► excess ─► push (rgba16float: acceleration)
//!                                                         rest density ──┘
//! ```
//!
//! **Blur.** A discrete Gaussian, whose variance is what it should be however narrow it is. All that a cell holds is
//! one texel of four words between the passes, and a thread fetches each texel once for four cells. On a CPU driver that
//! takes half the time of recursive averages over lines of cells in buffers, which were here before (at
//! 32³, a texel costs what a word of a buffer does), and the push depends less on the resolution
//! (7.74, 7.70, 7.71 m/s² on 24³, 32³, 64³ cells; before 7.04, 6.90, 6.71).
//!
//! **Samples.** Vertices closer than a cell or so are splatted together, at their middle and with their mean
//! motion. Of two vertices each, the density is off by 0.7 % and the momentum by 0.8 %; of a quarter of a
//! thousand guides, by 10 and 13 % with or without that.
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
//! **Cost.** A third of it is the splat: 40 atomic additions per sample. Grooms of more than
//! [`VolumeOptions::most_splatted`] samples splat every second, third, ... guide with its share of the hair.
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
    constants::VOLUME_WORKGROUP,
    gpu::{Binding, Kernel, bindings},
    simulate::{MAX_STEPS, RestGuides, SimulationParams, Step, params::Mode},
    strands::{GuideBuffers, buffers::storage},
};
use glam::Vec3;
use params::{Blur, VolumeUniforms};

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

/// The most vertices of a guide that become one sample.
const MOST_TOGETHER: u32 = 4;

/// The pipelines of the stage.
#[derive(Debug)]
pub struct VolumeStage {
    obstacles: Kernel,
    splat: Kernel,
    sum: Kernel,
    blur: [Kernel; 2],
    density: Kernel,
    push: Kernel,
    settle: Kernel,
}

impl VolumeStage {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        use Binding::{
            Storage as Read, StorageMut as Write, Texels3d, Uniform as Always, UniformDynamic as Uniform,
            Words3d, Write3d, WriteFull3d, WriteWords3d,
        };
        let kernel = |name, entries: &[Binding]| Kernel::new(device, name, entries);
        let colliders = collide::layout(device);
        Self {
            obstacles: Kernel::beside(device, "volume::obstacles", &[Uniform, Write], &[&colliders]),
            splat: kernel("volume::splat", &[Uniform, Read, Read, Read, Read, Read, Write]),
            sum: kernel("volume::sum", &[Uniform, Write, Read, WriteWords3d]),
            blur: ["volume::blur_x", "volume::blur_y"]
                .map(|name| kernel(name, &[Uniform, Always, Words3d, WriteWords3d])),
            density: kernel("volume::density", &[Uniform, Always, Words3d, Write, WriteFull3d, Write3d]),
            push: kernel("volume::push", &[Uniform, Texels3d, Write3d]),
            settle: kernel("volume::settle", &[Uniform, Read, Read, Write]),
        }
    }
}

/// The size of a groom's grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VolumeOptions {
    /// Cells along each axis, 8 to 96.
    pub resolution: u32,
    /// The most samples that are splatted in a step: vertices of guides, or a few together where they lie within
    /// a cell or so. Of more, every second guide counts twice, and so on.
    pub most_splatted: u32,
}

impl Default for VolumeOptions {
    fn default() -> Self {
        Self { resolution: 32, most_splatted: 4_096 }
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
    rest: wgpu::Buffer,
    blur: wgpu::Buffer,
    rested: wgpu::Buffer,
    groups: Groups,
    /// What does not change from step to step.
    base: VolumeUniforms,
    modes: Vec<Mode>,
    /// Whether the obstacles have moved when a step begins, and where relative to the head they were when
    /// they were last put into the grid.
    obstacles_moved: Vec<bool>,
    obstacles_at: Option<Vec<Pose>>,
    /// The variance (cells², as bits) of the blur for which the rest density was computed, if it was, of the one
    /// asked for, and of the one whose weights the GPU has.
    rest_blur: (Option<u32>, u32),
    written_blur: Option<u32>,
}

#[derive(Debug)]
struct Groups {
    obstacles: wgpu::BindGroup,
    splat: wgpu::BindGroup,
    sum: wgpu::BindGroup,
    blur: [wgpu::BindGroup; 2],
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
        let texture = |label, format| {
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
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let view = texture.create_view(&Default::default());
            (texture, view)
        };
        use wgpu::TextureFormat::{Rgba16Float, Rgba32Float, Rgba32Uint};
        let (hair_texture, hair) = texture("volume hair", Rgba16Float);
        let (push_texture, push) = texture("volume push", Rgba16Float);
        let [(_, first), (_, second)] =
            [texture("volume sums a", Rgba32Uint), texture("volume sums b", Rgba32Uint)];
        let (_, dense) = texture("volume density", Rgba32Float);
        let uniforms = bindings::uniform(device, "volume steps", (STRIDE * (MAX_STEPS + 1)) as usize);
        let cells = storage::<i32>(device, "volume cells", n * CHANNELS)?;
        let obstacles = storage::<f32>(device, "volume obstacles", n)?;
        let rest_density = storage::<f32>(device, "volume rest", n)?;
        let blur = bindings::uniform(device, "volume blur", size_of::<Blur>());
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
                &[step(), cells.as_entire_binding(), obstacles.as_entire_binding(), view(&first)],
            ),
            blur: [(&stage.blur[0], &first, &second), (&stage.blur[1], &second, &first)].map(
                |(kernel, from, to)| {
                    kernel.bind(device, &[step(), blur.as_entire_binding(), view(from), view(to)])
                },
            ),
            density: stage.density.bind(
                device,
                &[
                    step(),
                    blur.as_entire_binding(),
                    view(&first),
                    rest_density.as_entire_binding(),
                    view(&dense),
                    view(&hair),
                ],
            ),
            push: stage.push.bind(device, &[step(), view(&dense), view(&push)]),
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
            rest: rest_density,
            blur,
            rested,
            groups,
            base,
            modes: Vec::new(),
            obstacles_moved: Vec::new(),
            obstacles_at: None,
            rest_blur: (None, 0),
            written_blur: None,
        })
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let buffers = [&self.uniforms, &self.cells, &self.obstacles, &self.rest, &self.blur, &self.rested];
        // Hair and push, twice the sums, the density.
        let texels = (2 * 8 + 2 * 16 + 16) * u64::from(self.grid.resolution).pow(3);
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
        let variance = self.variance(&params.hair_hair);
        self.rest_blur.1 = variance.to_bits();
        if self.written_blur != Some(self.rest_blur.1) {
            queue.write_buffer(&self.blur, 0, bytemuck::bytes_of(&Blur::new(variance)));
            self.written_blur = Some(self.rest_blur.1);
        }
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
            stage.push.record_grid(pass, &self.groups.push, &[Self::offset(i)], self.tiles([1, 1, 1]));
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
        let splatted = (self.base.splat_count * self.base.samples).div_ceil(VOLUME_WORKGROUP);
        stage.splat.record(pass, &self.groups.splat, &offset, splatted);
        stage.sum.record_grid(pass, &self.groups.sum, &offset, self.tiles([1, 1, 1]));
        for (axis, four) in [[4, 1, 1], [1, 4, 1]].into_iter().enumerate() {
            stage.blur[axis].record_grid(pass, &self.groups.blur[axis], &offset, self.tiles(four));
        }
        stage.density.record_grid(pass, &self.groups.density, &offset, self.tiles([1, 1, 4]));
    }

    /// Workgroups for threads of so many cells each along each axis.
    fn tiles(&self, cells: [u32; 3]) -> [u32; 3] {
        let n = self.grid.resolution;
        [(0, 8), (1, 4), (2, 2)].map(|(axis, threads)| n.div_ceil(cells[axis]).div_ceil(threads))
    }

    /// The variance of the blur, cells². The splat itself blurs, by a sixth of a cell's square.
    fn variance(&self, params: &HairHair) -> f32 {
        let smooth = params.mode != HairHairMode::Fixed;
        if smooth { ((params.blur / self.base.cell).powi(2) - 1.0 / 6.0).max(0.0) } else { 0.0 }
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
        let speed = params.speed.min(params.blur.max(cell) / h.max(1e-6));
        VolumeUniforms {
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
    // The blur sees no gaps between samples that are up to one and a half cells apart.
    let edges = guides.vertex_count.saturating_sub(1).max(1) as f32;
    let lengths = rest.info.iter().map(|guide| (guide.strands * guide.length, guide.strands));
    let (metres_of, strands_of) = lengths.fold((0f32, 0f32), |sum, x| (sum.0 + x.0, sum.1 + x.1));
    let edge = metres_of / strands_of / edges;
    // Also where there is no hair or no number.
    let vertices_per_sample = ((1.5 * grid.cell / edge) as u32).clamp(1, MOST_TOGETHER);
    let samples = guides.vertex_count.div_ceil(vertices_per_sample);
    let stride = guides.count.saturating_mul(samples).div_ceil(most_splatted).max(1);
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
        vertices_per_sample,
        samples,
        one: 1,
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
