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
//! **Limits.** Light bounces once between meshes; more bounces are estimated, as in a cavity with evenly lit walls.
//! Hair reflects no light onto skin. A mesh hides as much of the sky as one that is larger by up to a cell.
//!
//! Rejected: probes that march rays (see above); lookups in the shadow maps of the zenith and the lights alone, which
//! were a fifth too bright under a gray sky; exact fractions for surfaces that span several cells, which block 3 % too
//! much at a wall instead of 11 %, but reflect a fifth too little light and leak along rays that cross many cells.
//! Untried: aligned fibers, which transmit more light along than across their direction.

use crate::{
    Context, Result,
    body::{self, Body},
    constants::{AMBIENT_STRANDS, STRAND_WORKGROUP},
    gpu::{BindBuffer, Commands, Kernel, bindings::linear_sampler, grid::grid_texture},
    shaders::kernels::light::{Transmittance, ambient as kernels},
    strands::DrawCount,
};

/// Quadrature directions, words per cell and layers of the result, as in the shaders.
const DIRECTIONS: u32 = 24;
const CELL_WORDS: u64 = 8;
/// Bytes of a settled cell.
const SETTLED: u64 = 16;
const LAYERS: u32 = 5;

/// Kernels of ambient light.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) splat_hair: Kernel,
    skin: Kernel,
    splat_radiance: Kernel,
    settle: Kernel,
    /// For sky light, then for mesh radiance.
    sweeps: [Kernel; 2],
    gathers: [Kernel; 2],
}

impl Pipelines {
    pub(super) fn new(context: &Context) -> Self {
        let device = &context.device;
        let surface = body::surface_layout(device);
        Self {
            splat_hair: Kernel::new::<kernels::SplatHair>(device),
            skin: Kernel::with_shared::<kernels::Skin>(device, &[&surface]),
            splat_radiance: Kernel::with_shared::<kernels::SplatRadiance>(device, &[&surface]),
            settle: Kernel::new::<kernels::Settle>(device),
            sweeps: Kernel::each::<kernels::Sweep, 2>(
                device,
                ["light::ambient::sweep", "light::ambient::sweep_radiance"],
            ),
            gathers: Kernel::each::<kernels::Gather, 2>(
                device,
                ["light::ambient::gather", "light::ambient::collect"],
            ),
        }
    }

    pub(super) fn kernels(&self) -> impl Iterator<Item = &Kernel> {
        let Self { splat_hair, skin, splat_radiance, settle, sweeps, gathers } = self;
        [splat_hair, skin, splat_radiance, settle].into_iter().chain(sweeps).chain(gathers)
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
        let sampler = linear_sampler(device);
        let (lights, sum) = (transmittance.lights, sums.entire());
        let (settled, fields, weights) = (settled.entire(), fields.entire(), weights.entire());
        let ambient = bindings(&result, &sampler);
        let sweep = kernels::Sweep { link: kernels::Link { lights, settled }, fields };
        let gather = kernels::Gather { lights, fields, weights, result: &result };
        let Pipelines { skin, splat_radiance, settle, sweeps, gathers, .. } = pipelines;
        Self {
            skin: skin.bind(&kernels::Skin { lights, cells: sum }),
            splat_radiance: splat_radiance.bind(&kernels::SplatRadiance {
                transmittance,
                ambient,
                cells: sum,
            }),
            settle: settle.bind(&kernels::Settle { lights, cells: sum, settled }),
            sweeps: sweeps.each_ref().map(|kernel| kernel.bind(&sweep)),
            gathers: gathers.each_ref().map(|kernel| kernel.bind(&gather)),
            cells,
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

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        Self::bytes_of(self.cells)
    }

    /// Returns the bytes of GPU memory of a grid with `cells` cells per edge.
    pub(super) fn bytes_of(cells: u32) -> u64 {
        let cells = u64::from(Self::within(cells));
        let cell = 4 * CELL_WORDS + SETTLED + 4 + 8 * u64::from(DIRECTIONS) + 8 * u64::from(LAYERS);
        cell * cells.pow(3)
    }

    /// Records all kernels. Call it after the shadow maps.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        commands: &mut Commands<'_>,
        hair: &[(DrawCount, &wgpu::BindGroup)],
        (bodies, every): (&[&Body], u32),
    ) -> Result<()> {
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
            let (kernel, group) =
                [(&pipelines.skin, &self.skin), (&pipelines.splat_radiance, &self.splat_radiance)][i];
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
        }
        recorded.end()
    }
}
