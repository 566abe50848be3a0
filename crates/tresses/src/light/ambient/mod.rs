//! Ambient light: the visibility of the sky within the hair, and the light that the body reflects onto it.
//!
//! ```text
//! strand vertices ──► lay ───┐                        ┌─ slice by slice ─┐
//! body, shadow maps ► glow ──┴► cells ─► settle ─► cells ─► sweep ─► fields, 24 ─► gather ─► five layers
//! ```
//!
//! A cube of cells around [`Picture::focus`](crate::view::Picture::focus), [`ViewOptions::ambient_cells`](crate::view::ViewOptions::ambient_cells) per
//! edge, rebuilt each frame. `lay` adds the area of the hair, width times length, in fixed point; `glow`
//! does the same with sample points over the body's surface ([`Surface`]), and adds the radiance that
//! leaves them, from the lights that reach them through the shadow maps and from the sky. `settle` turns
//! the sums into means.
//!
//! **Discrete ordinates.** `sweep` propagates light along the 24 directions of a level-symmetric quadrature
//! (the set named S4; Carlson and Lathrop 1965) through the cells, slice by slice, where each slice needs
//! only the previous one (short characteristics, Kunasz and Auer 1988). That is one step per cell and
//! direction, whereas marching rays from each cell takes as many as a ray crosses. It carries the fraction
//! of the sky that is left where fibres remove none, an eighth, half and all of the light that meets them:
//! the fraction for any absorption and colour channel is interpolated between these, and since this happens
//! before the sum over directions, thin and dense sides are not mixed. It also carries the radiance of the
//! body, of which each fibre removes what it does not pass on in dual scattering.
//!
//! **A body is a surface.** Cells hold the sum of its area as a vector. The surface in a cell hides what is
//! beyond it from the previous cells; from that cell itself only towards the body's inside: a cell on the
//! skin sees the whole sky above it and the skin below. Cells inside the body see nothing, and have no
//! weight in the interpolation.
//!
//! **Five layers.** `gather` keeps means and first moments over the directions. Shading needs averages over
//! the two half circles of azimuths in front of and behind a fibre, whose mean vectors are known, and for
//! those the first moments suffice (`ambient.wesl`). The body's own shading uses the same lookup.
//!
//! **What is seen.** Cells are 1 to 3 cm, and what an eye sees of dense hair lies within millimetres of its surface:
//! shading asks for the light before that, and takes of it what is left at the depth that eyes see to
//! (`ambient_seen`). A body's surface asks a cell before itself for what bodies hide, and nearer for hair.
//!
//! Light from body to body is not followed further than once; what a surface throws is multiplied as in a hollow whose
//! walls are lit alike. Light from hair to skin is left out. A body hides as much of the sky as one that is larger by up
//! to a cell. Rejected: probes that march rays (above); the earlier lookup in the shadow maps for the zenith
//! and the lights alone, which was a fifth too bright under a grey sky; exact shares of surfaces that several cells make
//! up, which hide a wall 3 % too much instead of 11 %, but throw a fifth too little of its light, and leak at rays
//! that pass many cells. Untried: aligned fibres transmit more light along than across them.

mod ask;

pub use ask::{AmbientProbe, Around};

use super::{FRAME, Seen};
use crate::{
    Context, Result,
    body::{self, Body},
    constants::{AMBIENT_STRANDS, STRAND_WORKGROUP},
    gpu::{Binding, Commands, Kernel, bindings::linear, grid::grid_texture},
};

/// Directions, words of a cell and layers, as in the shaders.
const DIRECTIONS: u32 = 24;
const CELL_WORDS: u64 = 8;
/// Bytes of a cell that is settled.
const SETTLED: u64 = 16;
const LAYERS: u32 = 5;
/// Distance between the numbers of two slices: the largest offset alignment WebGPU asks for.
const STEP: u64 = 256;

/// The kernels.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) lay: Kernel,
    skin: Kernel,
    glow: Kernel,
    settle: Kernel,
    /// Of the sky's light, then of the body's.
    sweeps: [Kernel; 2],
    gathers: [Kernel; 2],
}

impl Pipelines {
    pub(super) fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        use Binding::{Storage, StorageMut, Uniform, UniformDynamic, Write3d};
        let surface = body::surface_layout(device);
        let kernel = |module, entries: &[Binding]| Kernel::new(&context.device, module, entries);
        Self {
            lay: kernel("light::ambient::lay", &[Uniform, Uniform, Storage, Storage, StorageMut]),
            skin: Kernel::beside(
                &context.device,
                "light::ambient::skin",
                &[Uniform, StorageMut],
                &[&surface],
            ),
            // The first is nobody's: what asks for light binds the camera there.
            glow: Kernel::beside(
                &context.device,
                "light::ambient::glow",
                &[&FRAME[..], &[StorageMut]].concat(),
                &[&surface],
            ),
            settle: kernel("light::ambient::settle", &[Uniform, Storage, StorageMut]),
            sweeps: ["light::ambient::sweep", "light::ambient::shine"]
                .map(|module| kernel(module, &[Uniform, UniformDynamic, Storage, StorageMut])),
            gathers: ["light::ambient::gather", "light::ambient::collect"]
                .map(|module| kernel(module, &[Uniform, Storage, StorageMut, Write3d])),
        }
    }

    pub(super) fn kernels(&self) -> impl Iterator<Item = &Kernel> {
        let Self { lay, skin, glow, settle, sweeps, gathers } = self;
        [lay, skin, glow, settle].into_iter().chain(sweeps).chain(gathers)
    }
}

/// The cells of a view, and what comes of them.
#[derive(Debug)]
pub struct Ambient {
    cells: u32,
    sums: wgpu::Buffer,
    result: wgpu::TextureView,
    sampler: wgpu::Sampler,
    skin: wgpu::BindGroup,
    glow: wgpu::BindGroup,
    settle: wgpu::BindGroup,
    /// The sky's light, then the body's.
    sweeps: [wgpu::BindGroup; 2],
    gathers: [wgpu::BindGroup; 2],
}

impl Ambient {
    /// Cells to an edge: as many as `wanted`, from 4 to 64.
    pub(super) fn new(
        context: &Context,
        pipelines: &Pipelines,
        wanted: u32,
        lights: &wgpu::Buffer,
        shadow: [wgpu::BindingResource<'_>; 4],
    ) -> Self {
        let Context { device, .. } = context;
        let cells = Self::within(wanted);
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
        let slices = slices(device, cells);
        let format = wgpu::TextureFormat::Rgba16Float;
        let (_, result) = grid_texture(device, "ambient", format, [cells, cells, LAYERS * cells]);
        let sampler = linear(device);
        let all = wgpu::Buffer::as_entire_binding;
        let view = || wgpu::BindingResource::TextureView(&result);
        let [maps, comparison, hair, blocks] = shadow;
        let linear = wgpu::BindingResource::Sampler(&sampler);
        let frame = [all(lights), all(lights), maps, comparison, hair, blocks, view(), linear, all(&sums)];
        let slice = || {
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &slices,
                offset: 0,
                size: wgpu::BufferSize::new(16),
            })
        };
        let Pipelines { skin, glow, settle, sweeps, gathers, .. } = pipelines;
        Self {
            skin: skin.bind(&[all(lights), all(&sums)]),
            glow: glow.bind(&frame),
            settle: settle.bind(&[all(lights), all(&sums), all(&settled)]),
            sweeps: sweeps
                .each_ref()
                .map(|sweep| sweep.bind(&[all(lights), slice(), all(&settled), all(&fields)])),
            gathers: gathers
                .each_ref()
                .map(|gather| gather.bind(&[all(lights), all(&fields), all(&weights), view()])),
            cells,
            sampler: sampler.clone(),
            sums: sums.clone(),
            result: result.clone(),
        }
    }

    /// Cells along each edge of a grid that is asked for with so many.
    pub(super) fn within(wanted: u32) -> u32 {
        wanted.clamp(4, 64)
    }

    /// Every so many points of a body made for fine cells are enough for these.
    pub(super) fn every(&self) -> u32 {
        body::points_for(u32::MAX).checked_div(body::points_for(self.cells)).unwrap_or(1).max(1)
    }

    /// Cells to an edge.
    pub fn cells(&self) -> u32 {
        self.cells
    }

    /// The sums over the area of hair and bodies in each cell.
    pub(super) fn sums(&self) -> &wgpu::Buffer {
        &self.sums
    }

    /// What shaders need to ask for it: the layers and their sampler.
    pub(super) fn resources(&self) -> [wgpu::BindingResource<'_>; 2] {
        [wgpu::BindingResource::TextureView(&self.result), wgpu::BindingResource::Sampler(&self.sampler)]
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        Self::bytes_of(self.cells)
    }

    /// The same of so many cells to an edge that are not made yet.
    pub(super) fn bytes_of(cells: u32) -> u64 {
        let cells = u64::from(Self::within(cells));
        let cell = 4 * CELL_WORDS + SETTLED + 4 + 8 * u64::from(DIRECTIONS) + 8 * u64::from(LAYERS);
        cell * cells.pow(3) + STEP * cells
    }

    /// Records all of it; after the shadow maps.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        commands: &mut Commands<'_>,
        hair: &[Seen<'_>],
        (bodies, every): (&[&Body], u32),
    ) -> Result<()> {
        commands.clear(&self.sums, None);
        let mut recorded = commands.compute("ambient");
        let pass = &mut recorded;
        for Seen { hair, shaded, .. } in hair {
            let every = (hair.drawn.count / AMBIENT_STRANDS).max(1);
            let strands = u64::from(hair.drawn.count.div_ceil(every));
            let threads = strands * u64::from(hair.drawn.vertex_count.saturating_sub(1));
            let workgroups = threads.div_ceil(u64::from(STRAND_WORKGROUP)) as u32;
            pipelines.lay.record(pass, &shaded.lay, &[], workgroups);
        }
        let cells = self.cells.pow(3);
        let slice = [self.cells.pow(2).div_ceil(STRAND_WORKGROUP), DIRECTIONS, 1];
        for i in 0..2 {
            let (kernel, group) = [(&pipelines.skin, &self.skin), (&pipelines.glow, &self.glow)][i];
            for body in bodies {
                pass.set_bind_group(1, &body.surface_group, &[]);
                kernel.record(
                    pass,
                    group,
                    &[],
                    body.surface.points.div_ceil(every).div_ceil(STRAND_WORKGROUP),
                );
            }
            pipelines.settle.record(pass, &self.settle, &[], cells.div_ceil(STRAND_WORKGROUP));
            for slot in 0..u64::from(self.cells) {
                pipelines.sweeps[i].record_grid(pass, &self.sweeps[i], &[(STEP * slot) as u32], slice);
            }
            pipelines.gathers[i].record(pass, &self.gathers[i], &[], cells.div_ceil(STRAND_WORKGROUP));
        }
        recorded.end()
    }
}

/// The numbers of the slices, each at its own offset.
fn slices(device: &wgpu::Device, cells: u32) -> wgpu::Buffer {
    let mut numbers = vec![0_u32; (STEP / 4 * u64::from(cells)) as usize];
    for (slice, number) in numbers.iter_mut().step_by(STEP as usize / 4).enumerate() {
        *number = slice as u32;
    }
    use wgpu::util::DeviceExt;
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("ambient slices"),
        contents: bytemuck::cast_slice(&numbers),
        usage: wgpu::BufferUsages::UNIFORM,
    })
}
