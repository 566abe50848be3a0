//! Ambient light: sky visibility within the hair, and the light that meshes reflect onto it.
//!
//! ```text
//! strand vertices ──► splat_hair ─────┐                        ┌─ slice by slice ─┐
//! mesh, shadow maps ► splat_radiance ─┴► cells ─► settle ─► cells ─► sweep ─► fields, 24 ─► gather ─► five layers
//! ```
//!
//! The grid is a cube of cells around [`Picture::focus`](crate::view::Picture::focus) with
//! [`ViewOptions::ambient_resolution`](crate::view::ViewOptions::ambient_resolution) cells per edge, rebuilt each
//! frame. `splat_hair` adds the area of the hair (width times length) in fixed point. `skin` adds sample points of mesh
//! surfaces ([`Surface`](crate::body::Surface)). `splat_radiance` adds the radiance that leaves them, from the
//! shadow-mapped lights and the sky. `settle` turns the sums into means.
//!
//! **Discrete ordinates.** `sweep` propagates light through the cells along the 24 directions of a level-symmetric
//! quadrature (S4; Carlson and Lathrop 1965), slice by slice. Each slice needs only the previous one (short
//! characteristics, Kunasz and Auer 1988). A workgroup propagates one direction, with a barrier between slices: a
//! dispatch per slice would cost a GPU more than the slice. This takes one step per cell and direction, whereas ray
//! marching from each cell takes as many steps as a ray crosses cells. `sweep` carries the fraction of the sky that
//! remains if fibers remove 0, 1/8, 1/2 or all of the light that hits them. Shading interpolates between these for the
//! absorption of each color channel. Light is attenuated before the sum over directions, so thin and dense sides do not
//! mix. `sweep_radiance` carries the radiance of meshes. Each fiber removes the part that it does not pass on in dual
//! scattering.
//!
//! **Meshes as surfaces.** Cells hold the sum of mesh area as a vector. The surface in a cell blocks the light that
//! passes through the cell. For the cell itself it blocks only the directions into the mesh: a cell on the skin sees
//! the whole sky above it and the skin below. Cells inside a mesh receive no light, and have no weight in the
//! interpolation.
//!
//! **Five layers.** `gather` and `collect` store means and first moments over the directions. Shading needs averages
//! over the half circles of azimuths in front of and behind a fiber. Their mean vectors are known, so first moments
//! suffice (`ambient.wesl`). Mesh shading uses the same lookup.
//!
//! **Visible hair.** Cells are 1 to 3 cm wide, but the visible fibers of dense hair lie within millimeters of its
//! surface. Shading reads the light in front of the surface, and attenuates it to the depth that eye rays reach
//! (`ambient_at_fiber`). A mesh surface reads occlusion by meshes one cell in front of itself, and hair closer to it.
//!
//! **Lights without shadow maps.** `gather_unmapped` adds up to 256 lights to each cell: their irradiance there,
//! attenuated like the sky in the directions around theirs. Means and first moments of their radiance, per channel, go
//! into four layers of their own, which shading reads as it reads the sky, and only in frames that have such lights.
//!
//! **Limits.** Light bounces once between meshes; more bounces are estimated, as in a cavity with evenly lit walls.
//! Hair reflects no light onto skin. A mesh hides as much of the sky as one that is larger by up to a cell.
//!
//! Rejected: probes that march rays (see above); lookups in the shadow maps of the zenith and the lights alone, which
//! were a fifth too bright under a gray sky; exact fractions for surfaces that span several cells, which block 3 % too
//! much at a wall instead of 11 %, but reflect a fifth too little light and leak along rays that cross many cells.
//! Untried: aligned fibers, which transmit more light along than across their direction.

use super::lights::LightUniform;
use crate::{
    Context, Result,
    body::{self, Body},
    constants::{AMBIENT_STRANDS, MAX_UNMAPPED_LIGHTS, STRAND_WORKGROUP},
    gpu::{BindBuffer, Commands, Kernel, Queue, bindings::linear_sampler, grid::grid_texture},
    shaders::kernels::light::{Transmittance, ambient as kernels},
    strands::DrawCount,
};

/// Quadrature directions, words per cell and layers of the result, as in the shaders.
const DIRECTIONS: u32 = 24;
const CELL_WORDS: u64 = 8;
/// Bytes of a settled cell.
const SETTLED: u64 = 16;
const LAYERS: u32 = 5;
/// Layers of the light without shadow maps.
const UNMAPPED_LAYERS: u32 = 4;

/// Kernels of ambient light.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) splat_hair: Kernel,
    skin: Kernel,
    /// For distant lights only, and for all.
    splat_radiance: [Kernel; 2],
    settle: Kernel,
    /// For sky light, then for mesh radiance.
    sweeps: [Kernel; 2],
    gathers: [Kernel; 2],
    gather_unmapped: Kernel,
}

impl Pipelines {
    pub(super) fn new(context: &Context) -> Self {
        let device = &context.device;
        let surface = body::surface_layout(device);
        Self {
            splat_hair: Kernel::new::<kernels::SplatHair>(device),
            skin: Kernel::with_shared::<kernels::Skin>(device, &[&surface]),
            splat_radiance: ["light::ambient::splat_radiance::0", "light::ambient::splat_radiance::2"]
                .map(|module| Kernel::named::<kernels::SplatRadiance>(device, module, &[&surface])),
            settle: Kernel::new::<kernels::Settle>(device),
            sweeps: Kernel::each::<kernels::Sweep, 2>(
                device,
                ["light::ambient::sweep", "light::ambient::sweep_radiance"],
            ),
            gathers: Kernel::each::<kernels::Gather, 2>(
                device,
                ["light::ambient::gather", "light::ambient::collect"],
            ),
            gather_unmapped: Kernel::new::<kernels::GatherUnmapped>(device),
        }
    }

    pub(super) fn kernels(&self) -> impl Iterator<Item = &Kernel> {
        // Frames without lights that have no shadow map need no `gather_unmapped`.
        let Self { splat_hair, skin, splat_radiance, settle, sweeps, gathers, .. } = self;
        [splat_hair, skin, &splat_radiance[0], settle].into_iter().chain(sweeps).chain(gathers)
    }
}

fn bindings<'a>(grid: &'a wgpu::TextureView, sampler: &'a wgpu::Sampler) -> kernels::Ambient<'a> {
    kernels::Ambient { ambient_grid: grid, ambient_linear: sampler }
}

/// Ambient light grid of a view.
#[derive(Debug)]
pub(crate) struct Ambient {
    cells: u32,
    sums: wgpu::Buffer,
    result: wgpu::TextureView,
    /// Light without shadow maps.
    unmapped_grid: wgpu::TextureView,
    /// Lights without shadow maps.
    unmapped: wgpu::Buffer,
    gather_unmapped: wgpu::BindGroup,
    sampler: wgpu::Sampler,
    skin: wgpu::BindGroup,
    splat_radiance: wgpu::BindGroup,
    settle: wgpu::BindGroup,
    /// For sky light, then for mesh radiance.
    sweeps: [wgpu::BindGroup; 2],
    gathers: [wgpu::BindGroup; 2],
}

impl Ambient {
    /// Creates a grid of `requested_cells` per edge, clamped to 4 to 64.
    pub(super) fn new(
        context: &Context,
        pipelines: &Pipelines,
        requested_cells: u32,
        transmittance: Transmittance<'_>,
    ) -> Self {
        let Context { device, .. } = context;
        let cells = Self::within(requested_cells);
        let count = u64::from(cells).pow(3);
        let storage = |label, size| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let sums = storage("ambient sums", 4 * CELL_WORDS * count);
        let settled = storage("ambient cells", SETTLED * count);
        let fields = storage("ambient fields", 8 * u64::from(DIRECTIONS) * count);
        let weights = storage("ambient weights", 4 * count);
        let format = wgpu::TextureFormat::Rgba16Float;
        let (_, result) = grid_texture(device, "ambient", format, [cells, cells, LAYERS * cells]);
        let size = [cells, cells, UNMAPPED_LAYERS * cells];
        let (_, unmapped_grid) = grid_texture(device, "unmapped lights in cells", format, size);
        let unmapped =
            storage("unmapped lights", u64::from(MAX_UNMAPPED_LIGHTS) * size_of::<LightUniform>() as u64);
        let sampler = linear_sampler(device);
        let (lights, sum) = (transmittance.lights, sums.entire());
        let (settled, fields, weights) = (settled.entire(), fields.entire(), weights.entire());
        let ambient = bindings(&result, &sampler);
        let sweep = kernels::Sweep { link: kernels::Link { lights, settled }, fields };
        let gather = kernels::Gather { lights, fields, weights, result: &result };
        let Pipelines { skin, splat_radiance, settle, sweeps, gathers, gather_unmapped, .. } = pipelines;
        let bound =
            kernels::GatherUnmapped { lights, fields, unmapped: unmapped.entire(), result: &unmapped_grid };
        Self {
            skin: skin.bind(&kernels::Skin { lights, cells: sum }),
            splat_radiance: splat_radiance[0].bind(&kernels::SplatRadiance {
                transmittance,
                ambient,
                unmapped_grid: &unmapped_grid,
                cells: sum,
            }),
            settle: settle.bind(&kernels::Settle { lights, cells: sum, settled }),
            sweeps: sweeps.each_ref().map(|kernel| kernel.bind(&sweep)),
            gathers: gathers.each_ref().map(|kernel| kernel.bind(&gather)),
            gather_unmapped: gather_unmapped.bind(&bound),
            cells,
            unmapped: unmapped.clone(),
            unmapped_grid: unmapped_grid.clone(),
            sampler: sampler.clone(),
            sums: sums.clone(),
            result: result.clone(),
        }
    }

    /// Clamps a number of cells per edge to the supported range.
    pub(super) fn within(cells: u32) -> u32 {
        cells.clamp(4, 64)
    }

    /// Returns the stride through the sample points of mesh surfaces. Meshes have enough points for the finest grid;
    /// coarser grids need only every n-th.
    pub(super) fn every(&self) -> u32 {
        body::points_for(u32::MAX).checked_div(body::points_for(self.cells)).unwrap_or(1).max(1)
    }

    /// Cells per edge.
    pub fn cells(&self) -> u32 {
        self.cells
    }

    /// Buffer of the sums of hair and mesh area per cell.
    pub(super) fn sums(&self) -> &wgpu::Buffer {
        &self.sums
    }

    /// Bindings of kernels that read ambient light.
    pub(super) fn bindings(&self) -> kernels::Ambient<'_> {
        bindings(&self.result, &self.sampler)
    }

    /// Light without shadow maps, four layers of cells.
    pub(super) fn unmapped_grid(&self) -> &wgpu::TextureView {
        &self.unmapped_grid
    }

    /// Uploads the lights without shadow maps.
    pub(super) fn prepare(&self, queue: &Queue, lights: &[LightUniform]) {
        if !lights.is_empty() {
            queue.write_buffer(&self.unmapped, 0, bytemuck::cast_slice(lights));
        }
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        Self::bytes_of(self.cells)
    }

    /// Returns the bytes of GPU memory of a grid with `cells` cells per edge.
    pub(super) fn bytes_of(cells: u32) -> u64 {
        let cells = u64::from(Self::within(cells));
        let layers = LAYERS + UNMAPPED_LAYERS;
        let cell = 4 * CELL_WORDS + SETTLED + 4 + 8 * u64::from(DIRECTIONS) + 8 * u64::from(layers);
        cell * cells.pow(3) + u64::from(MAX_UNMAPPED_LIGHTS) * size_of::<LightUniform>() as u64
    }

    /// Records all kernels. Call it after the shadow maps.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        commands: &mut Commands<'_>,
        hair: &[(DrawCount, &wgpu::BindGroup)],
        (bodies, every): (&[&Body], u32),
        (near_lights, has_unmapped): (bool, bool),
    ) -> Result<()> {
        let splat_radiance = &pipelines.splat_radiance[usize::from(near_lights)];
        commands.clear(&self.sums, None);
        let mut recorded = commands.compute("ambient");
        let pass = &mut recorded;
        for (drawn, group) in hair {
            let every = (drawn.count / AMBIENT_STRANDS).max(1);
            let strands = u64::from(drawn.count.div_ceil(every));
            let threads = strands * u64::from(drawn.vertex_count.saturating_sub(1));
            let workgroups = threads.div_ceil(u64::from(STRAND_WORKGROUP)) as u32;
            pipelines.splat_hair.record(pass, group, &[], workgroups);
        }
        let cells = self.cells.pow(3);
        for i in 0..2 {
            let (kernel, group) = [(&pipelines.skin, &self.skin), (splat_radiance, &self.splat_radiance)][i];
            for body in bodies {
                pass.set_bind_group(1, &body.surface_group, &[]);
                kernel.record(
                    pass,
                    group,
                    &[],
                    body.surface().points.div_ceil(every).div_ceil(STRAND_WORKGROUP),
                );
            }
            pipelines.settle.record(pass, &self.settle, &[], cells.div_ceil(STRAND_WORKGROUP));
            pipelines.sweeps[i].record(pass, &self.sweeps[i], &[], DIRECTIONS);
            pipelines.gathers[i].record(pass, &self.gathers[i], &[], cells.div_ceil(STRAND_WORKGROUP));
            // The light that bodies reflect includes these lights.
            if i == 0 && has_unmapped {
                let groups = cells.div_ceil(STRAND_WORKGROUP);
                pipelines.gather_unmapped.record(pass, &self.gather_unmapped, &[], groups);
            }
        }
        recorded.end()
    }
}
