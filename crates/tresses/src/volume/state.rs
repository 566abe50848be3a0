//! Grid of one groom: its buffers, and the passes recorded for it in a step.

use super::{
    HairHair, HairHairMode, Pipelines, VolumeGrid,
    neighbor::Neighbor,
    params::{Blur, STRIDE, VolumeUniforms, offset},
};
use crate::{
    Context, Error, Pose, Result,
    clock::{MAX_STEPS, Mode, Steps},
    collide::ColliderSet,
    constants::VOLUME_WORKGROUP,
    gpu::{BindBuffer, BufferBinding, Commands, Opaque, Uniform, grid::grid_texture},
    shaders::kernels::volume as kernels,
    strands::{GuideBuffers, RestGuides, buffers::storage},
};
use glam::Vec3;
use std::sync::Arc;

/// Slot of the uniforms of the rest pose, after those of a frame's steps.
const RESTING: u32 = MAX_STEPS;
/// Integers per cell; the same as in the shaders.
const CHANNELS: u64 = 8;
/// Size of a groom's grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VolumeOptions {
    /// Cells along each axis, 8 to 96.
    pub resolution: u32,
    /// Maximum number of samples splatted per step. A sample is a guide vertex, or a few within about a cell. For
    /// larger grooms, every second guide counts twice, and so on.
    pub max_samples: u32,
}

impl Default for VolumeOptions {
    fn default() -> Self {
        Self { resolution: 32, max_samples: 4_096 }
    }
}

impl VolumeOptions {
    /// Returns the number of cells.
    fn cells(&self) -> Result<u32> {
        if !(8..=96).contains(&self.resolution) {
            return Err(Error::Parameter {
                name: "grid resolution",
                value: self.resolution.to_string(),
                range: "from 8 to 96 cells",
            });
        }
        Ok(self.resolution.pow(3))
    }

    /// Returns the size of the buffer for a step's splatted hair, bytes.
    pub(crate) fn cell_bytes(&self) -> Result<u64> {
        Ok(u64::from(self.cells()?) * CHANNELS * size_of::<i32>() as u64)
    }
}

/// The grid of one groom.
#[derive(Debug)]
pub(crate) struct Volume {
    pub(super) pipelines: Arc<Pipelines>,
    /// Position and size of the grid.
    pub(crate) grid: VolumeGrid,
    /// Mean velocity of hair (xyz, m/s, world axes) and its length per volume (w, km/m³), 3-D, rgba16float.
    pub hair: wgpu::TextureView,
    /// Acceleration by the excess density (xyz, m/s², axes of the head), 3-D, rgba16float.
    pub push: wgpu::TextureView,
    uniforms: Uniform,
    pub(super) cells: wgpu::Buffer,
    /// Whether the cells are in memory that others use between steps.
    lent: bool,
    obstacles: wgpu::Buffer,
    rest: wgpu::Buffer,
    blur: Uniform,
    pub(super) rested: wgpu::Buffer,
    /// Other grooms in this grid, and whether they have been set since the last frame began.
    pub(super) neighbors: Vec<Neighbor>,
    pub(super) has_new_neighbors: bool,
    /// Textures of sums, used in turn; the second also holds densities.
    scratch: [wgpu::TextureView; 2],
    pub(super) groups: Groups,
    /// Uniforms that stay constant between steps.
    pub(super) base: VolumeUniforms,
    modes: Vec<Mode>,
    /// Whether the obstacles have moved at the start of each step, and their poses relative to the head when they were
    /// last written to the grid.
    obstacle_changes: Vec<bool>,
    obstacles_at: Option<Vec<Pose>>,
    /// Variances of the blur (cells², as bits): of the one for which the rest density was computed, if it was; of the
    /// current one; and of the one whose weights are on the GPU.
    rest_blur: (Option<u32>, u32),
    written_blur: Option<u32>,
}

#[derive(Debug)]
pub(super) struct Groups {
    pub(super) obstacles: wgpu::BindGroup,
    pub(super) splat: wgpu::BindGroup,
    pub(super) sum: wgpu::BindGroup,
    pub(super) blur: [wgpu::BindGroup; 2],
    pub(super) density: wgpu::BindGroup,
    pub(super) push: wgpu::BindGroup,
    pub(super) settle: wgpu::BindGroup,
}

/// Textures and buffers that the grids of all hair of a groom use in turn. They hold a head's hair during one of its
/// steps, so steps of two heads must not interleave; [`Recorder`](crate::frame::Recorder) ensures this.
#[derive(Debug)]
pub(crate) struct VolumeAsset {
    grid: VolumeGrid,
    /// Hair and push.
    textures: [(wgpu::Texture, wgpu::TextureView); 2],
    cells: wgpu::Buffer,
    /// Whether the cells are in memory that others use between steps.
    lent: bool,
    scratch: [wgpu::TextureView; 2],
    base: VolumeUniforms,
}

impl VolumeAsset {
    /// Creates the grid around guides with the rest state `rest`, in `cells` that others use between steps, or in its
    /// own.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a resolution out of range, [`Error::Limit`] if the adapter cannot hold the grid.
    pub fn new(
        context: &Context,
        rest: &RestGuides,
        options: &VolumeOptions,
        cells: Option<wgpu::Buffer>,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let VolumeOptions { resolution, max_samples } = *options;
        let n = u64::from(options.cells()?);
        let (lent, own) = (cells.is_some(), || storage::<i32>(device, "volume cells", n * CHANNELS));
        let grid = VolumeGrid::around(rest.rest.iter().map(|r| r.position), resolution);
        let texture = |label, format| grid_texture(device, label, format, [resolution; 3]);
        use wgpu::TextureFormat::{Rgba16Float, Rgba32Uint};
        Ok(Self {
            base: VolumeUniforms::of(&grid, rest, max_samples.max(1)),
            grid,
            textures: [texture("volume hair", Rgba16Float), texture("volume push", Rgba16Float)],
            cells: cells.map_or_else(own, Ok)?,
            lent,
            scratch: ["volume sums a", "volume sums b"].map(|label| texture(label, Rgba32Uint).1),
        })
    }

    /// Bytes of GPU memory, without lent cells.
    pub fn bytes(&self) -> u64 {
        // Hair and push, and two textures of sums.
        let texels = (2 * 8 + 2 * 16) * u64::from(self.grid.resolution).pow(3);
        texels + if self.lent { 0 } else { self.cells.size() }
    }
}

impl Volume {
    /// Creates the grid of one head with `guides`.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn new(context: &Context, asset: &VolumeAsset, guides: &GuideBuffers) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let n = u64::from(asset.grid.resolution).pow(3);
        let vertices = u64::from(guides.count) * u64::from(guides.vertex_count);
        let uniforms = device.uniform((STRIDE * (MAX_STEPS + 1)) as usize);
        let blur = device.uniform(size_of::<Blur>());
        let obstacles = storage::<f32>(device, "volume obstacles", n)?;
        let rest = storage::<f32>(device, "volume rest", n)?;
        let rested = storage::<f32>(device, "volume rested", vertices)?;
        let [(_, hair), (_, push)] = asset.textures.clone();
        let (cells, scratch) = (asset.cells.clone(), asset.scratch.clone());
        let buffers = [&cells, &obstacles, &rest, &rested];
        let groups = Groups::new(
            &pipelines,
            guides,
            [&uniforms, &blur],
            buffers,
            [&hair, &push, &scratch[0], &scratch[1]],
        );
        Ok(Self {
            pipelines,
            grid: asset.grid,
            hair,
            push,
            uniforms,
            cells,
            lent: asset.lent,
            obstacles,
            rest,
            blur,
            rested,
            neighbors: Vec::new(),
            has_new_neighbors: false,
            scratch,
            groups,
            base: asset.base,
            modes: Vec::new(),
            obstacle_changes: Vec::new(),
            obstacles_at: None,
            rest_blur: (None, 0),
            written_blur: None,
        })
    }

    /// Binds other buffers of the same guides.
    pub(crate) fn bind(&mut self, guides: &GuideBuffers) {
        let buffers = [&self.cells, &self.obstacles, &self.rest, &self.rested];
        let views = [&self.hair, &self.push, &self.scratch[0], &self.scratch[1]];
        self.groups = Groups::new(&self.pipelines, guides, [&self.uniforms, &self.blur], buffers, views);
    }

    /// Bytes of GPU memory of this head alone.
    pub(crate) fn own_bytes(&self) -> u64 {
        let buffers = [&self.obstacles, &self.rest, &self.rested];
        let buffers: u64 = buffers.iter().map(|buffer| buffer.size()).sum();
        self.uniforms.size() + self.blur.size() + buffers
    }

    /// Clears cells that others have used since the last step. The caller calls this before a step, outside of passes.
    pub(crate) fn clear(&self, commands: &mut Commands<'_>) {
        if self.lent {
            let bytes = u64::from(self.grid.resolution).pow(3) * CHANNELS * size_of::<i32>() as u64;
            commands.clear(&self.cells, Some(bytes));
        }
    }

    /// Writes the uniforms of the steps of `frame`, at most the last [`MAX_STEPS`]. The caller has advanced `colliders`
    /// to the frame.
    pub fn prepare(&mut self, params: &HairHair, frame: &Steps<'_>, colliders: &ColliderSet) {
        let (h, steps) = (frame.length, frame.last());
        self.modes = steps.iter().map(|step| step.mode).collect();
        self.obstacle_changes = (0..steps.len())
            .map(|i| self.obstacles_move(&steps[i].begin, colliders, i * frame.substeps as usize))
            .collect();
        let base = self.with(params, h);
        let unit_scale = self.shared_units() as f32;
        // The rest density is valid for one blur.
        let variance = self.variance(params);
        self.rest_blur.1 = variance.to_bits();
        if self.written_blur != Some(self.rest_blur.1) {
            self.blur.write(0, bytemuck::bytes_of(&Blur::new(variance)));
            self.written_blur = Some(self.rest_blur.1);
        }
        let mut slots = Slots::new(RESTING + 1);
        for (i, step) in steps.iter().enumerate() {
            let moment = i as u32 * frame.substeps;
            let (units, density) = (base.units * unit_scale, base.density / unit_scale);
            let placed = base.placed(&step.begin, step.drift(h));
            slots.put(i as u32, &VolumeUniforms { moment, units, density, ..placed });
        }
        let resting = base.placed(&Pose::IDENTITY, Vec3::ZERO);
        slots.put(RESTING, &VolumeUniforms { resting: 1, ..resting });
        self.uniforms.write(0, &slots.0);
    }

    /// Records step `i` of those written by [`prepare`](Self::prepare).
    pub fn record(&mut self, pass: &mut crate::gpu::ComputePass<'_>, colliders: &ColliderSet, i: u32) {
        let mode = self.modes[i as usize];
        if self.obstacle_changes[i as usize] {
            pass.set_bind_group(1, colliders.group(), &[]);
            let cells = self.grid.resolution.pow(3).div_ceil(VOLUME_WORKGROUP);
            self.pipelines.obstacles.record(pass, &self.groups.obstacles, &[offset(i)], cells);
        }
        if mode == Mode::Reset || (mode == Mode::Step && self.rest_blur.0 != Some(self.rest_blur.1)) {
            self.grids(pass, RESTING);
            let vertices = self.base.guide_count * self.base.vertex_count;
            let workgroups = vertices.div_ceil(VOLUME_WORKGROUP);
            self.pipelines.settle.record(pass, &self.groups.settle, &[offset(RESTING)], workgroups);
            self.rest_blur.0 = Some(self.rest_blur.1);
        }
        if mode == Mode::Step {
            self.grids(pass, i);
            self.pipelines.push.record_grid(pass, &self.groups.push, &[offset(i)], self.tiles([1, 1, 1]));
        }
    }

    /// Returns whether any of `colliders` has moved relative to the head (at `head`) at `moment`, since they were last
    /// written to the grid. Remembers the new poses.
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

    /// Records the splat and the blur: this groom's hair and, in a step, hair of other grooms.
    pub(super) fn grids(&self, pass: &mut crate::gpu::ComputePass<'_>, slot: u32) {
        let offset = [offset(slot)];
        self.pipelines.splat.record(pass, &self.groups.splat, &offset, self.base.splat_workgroups());
        if slot != RESTING {
            self.neighbors.iter().for_each(|other| other.record(&self.pipelines, pass, slot));
        }
        self.pipelines.sum.record_grid(pass, &self.groups.sum, &offset, self.tiles([1, 1, 1]));
        for (axis, four) in [[4, 1, 1], [1, 4, 1]].into_iter().enumerate() {
            self.pipelines.blur[axis].record_grid(pass, &self.groups.blur[axis], &offset, self.tiles(four));
        }
        self.pipelines.density.record_grid(pass, &self.groups.density, &offset, self.tiles([1, 1, 4]));
    }

    /// Returns the workgroups for threads that process `cells` cells along each axis.
    pub(super) fn tiles(&self, cells: [u32; 3]) -> [u32; 3] {
        let n = self.grid.resolution;
        [(0, 8), (1, 4), (2, 2)].map(|(axis, threads)| n.div_ceil(cells[axis]).div_ceil(threads))
    }

    /// Returns the variance of the blur, cells². The splat itself adds a sixth of a cell squared.
    fn variance(&self, params: &HairHair) -> f32 {
        let smooth = params.mode != HairHairMode::Fixed;
        if smooth { ((params.blur / self.base.cell).powi(2) - 1.0 / 6.0).max(0.0) } else { 0.0 }
    }

    /// Returns the uniforms of one step, for binding with a dynamic offset.
    pub(crate) fn uniforms(&self) -> BufferBinding<'_, Opaque> {
        slot(&self.uniforms)
    }

    /// Returns the uniforms with the user's parameters.
    pub(super) fn with(&self, params: &HairHair, h: f32) -> VolumeUniforms {
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

impl Groups {
    /// Binds the kernels to the `guides` of one head.
    fn new(
        pipelines: &Pipelines,
        guides: &GuideBuffers,
        [uniforms, blur]: [&Uniform; 2],
        [cells, obstacles, rest, rested]: [&wgpu::Buffer; 4],
        [hair, push, first, second]: [&wgpu::TextureView; 4],
    ) -> Self {
        let (g, kernel) = (slot(uniforms), blur.entire());
        let (cells, obstacles, info) = (cells.entire(), obstacles.entire(), guides.info.entire());
        let filter = |unblurred| kernels::Filter { g, kernel, unblurred };
        let (at_rest, rested) = (rest.entire(), rested.entire());
        let settle = kernels::Settle { g, rest: guides.rest.entire(), dense: at_rest, rested, info };
        Self {
            obstacles: pipelines.obstacles.bind(&kernels::Obstacles { g, filled: obstacles }),
            splat: splat(pipelines, uniforms, guides, rested, cells),
            sum: pipelines.sum.bind(&kernels::Sum { g, cells, obstacles, unblurred: first }),
            blur: [(&pipelines.blur[0], first, second), (&pipelines.blur[1], second, first)]
                .map(|(kernel, from, blurred)| kernel.bind(&kernels::Blur { filter: filter(from), blurred })),
            density: pipelines.density.bind(&kernels::Density {
                filter: filter(first),
                rest: at_rest,
                dense: second,
                hair,
            }),
            push: pipelines.push.bind(&kernels::Push { g, dense: second, push_out: push }),
            settle: pipelines.settle.bind(&settle),
        }
    }
}

/// Binds the kernel that adds the hair of `guides` to `cells`.
pub(super) fn splat(
    pipelines: &Pipelines,
    uniforms: &Uniform,
    guides: &GuideBuffers,
    rested: BufferBinding<'_, f32>,
    cells: BufferBinding<'_, i32>,
) -> wgpu::BindGroup {
    pipelines.splat.bind(&kernels::Splat {
        g: slot(uniforms),
        info: guides.info.entire(),
        rest: guides.rest.entire(),
        current: guides.current.entire(),
        velocity: guides.velocity.entire(),
        rested,
        cells,
    })
}

/// Uniforms of several steps in the layout of the buffer.
pub(super) struct Slots(pub Vec<u8>);

impl Slots {
    /// Returns `count` empty slots.
    pub fn new(count: u32) -> Self {
        Self(vec![0; (STRIDE * count) as usize])
    }

    /// Writes the uniforms of step `i`.
    pub fn put(&mut self, i: u32, uniforms: &VolumeUniforms) {
        let at = (i * STRIDE) as usize;
        self.0[at..at + size_of::<VolumeUniforms>()].copy_from_slice(bytemuck::bytes_of(uniforms));
    }
}

/// Binding of one step's uniforms.
fn slot(uniforms: &Uniform) -> BufferBinding<'_, Opaque> {
    uniforms.part(0, Some(size_of::<VolumeUniforms>() as u64))
}
