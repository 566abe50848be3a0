//! Ambient light: the visibility of the sky within the hair, and the light that the body reflects onto it.
//!
//! ```text
//! strand vertices ──► lay ───┐                        ┌─ slice by slice ─┐
//! body, shadow maps ► glow ──┴► cells ─► settle ─► cells ─► sweep ─► fields, 24 ─► gather ─► five layers
//! ```
//!
//! A cube of cells around [`Scene::focus`](crate::draw::Scene::focus), [`DrawOptions::ambient_cells`] per
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
//! Light reflected by bodies is a single bounce: light from skin to skin to hair, and from hair to skin, is
//! left out. Rejected: probes that march rays (above); the earlier lookup in the shadow maps for the zenith
//! and the lights alone, which was a fifth too bright under a grey sky. Untried: aligned fibres transmit
//! more light along than across them.

mod ask;
mod surface;

pub use ask::{AmbientProbe, Around};
pub use surface::Surface;

use crate::{
    constants::{AMBIENT_STRANDS, STRAND_WORKGROUP},
    draw::{Body, HairSet},
    gpu::{
        Binding, Kernel, Timings,
        bindings::{group, layout, linear},
        grid::grid_texture,
    },
    strands::StrandBuffers,
};

#[cfg(doc)]
use crate::draw::DrawOptions;

/// Directions, words of a cell and layers, as in the shaders.
const DIRECTIONS: u32 = 24;
const CELL_WORDS: u64 = 8;
const LAYERS: u32 = 5;
/// Distance between the numbers of two slices: the largest offset alignment WebGPU asks for.
const STEP: u64 = 256;

/// The cells, what comes of them, and the kernels.
#[derive(Debug)]
pub struct Ambient {
    cells: u32,
    sums: wgpu::Buffer,
    result: wgpu::TextureView,
    sampler: wgpu::Sampler,
    body_layout: wgpu::BindGroupLayout,
    lay: Kernel,
    skin: Run,
    glow: Run,
    settle: Run,
    /// The sky's light, then the body's.
    sweeps: [Run; 2],
    gathers: [Run; 2],
}

/// A kernel and what it binds.
#[derive(Debug)]
struct Run {
    kernel: Kernel,
    group: wgpu::BindGroup,
}

impl Run {
    fn new(device: &wgpu::Device, kernel: Kernel, resources: &[wgpu::BindingResource<'_>]) -> Self {
        Self { group: kernel.bind(device, resources), kernel }
    }

    fn record(&self, pass: &mut wgpu::ComputePass<'_>, threads: u32) {
        self.kernel.record(pass, &self.group, &[], threads.div_ceil(STRAND_WORKGROUP));
    }
}

impl Ambient {
    /// Cells to an edge: as many as `wanted`, from 4 to 64.
    pub(crate) fn new(
        device: &wgpu::Device,
        wanted: u32,
        lights: &wgpu::Buffer,
        shadow: [wgpu::BindingResource<'_>; 4],
    ) -> Self {
        use Binding::{
            Comparison, DepthArray, Sampler, Storage, StorageMut, Texture3d, Uniform, UniformDynamic, Write3d,
        };
        let cells = wanted.clamp(4, 64);
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
        let settled = storage("ambient cells", 32 * count);
        let fields = storage("ambient fields", 8 * u64::from(DIRECTIONS) * count);
        let weights = storage("ambient weights", 4 * count);
        let slices = slices(device, cells);
        let format = wgpu::TextureFormat::Rgba16Float;
        let (_, result) = grid_texture(device, "ambient", format, [cells, cells, LAYERS * cells]);
        let sampler = linear(device);
        let body_layout =
            layout(device, "surface", wgpu::ShaderStages::COMPUTE, &[Uniform, Storage, Storage]);
        let all = wgpu::Buffer::as_entire_binding;
        let view = || wgpu::BindingResource::TextureView(&result);
        let lay =
            Kernel::new(device, "light::ambient::lay", &[Uniform, Uniform, Storage, Storage, StorageMut]);
        let skin = Kernel::beside(device, "light::ambient::skin", &[Uniform, StorageMut], &[&body_layout]);
        let skin = Run::new(device, skin, &[all(lights), all(&sums)]);
        // The first is nobody's: what asks for light binds the view there.
        let entries =
            [Uniform, Uniform, DepthArray, Comparison, Storage, Storage, Texture3d, Sampler, StorageMut];
        let glow = Kernel::beside(device, "light::ambient::glow", &entries, &[&body_layout]);
        let [maps, comparison, hair, blocks] = shadow;
        let linear = wgpu::BindingResource::Sampler(&sampler);
        let frame = [all(lights), all(lights), maps, comparison, hair, blocks, view(), linear, all(&sums)];
        let glow = Run::new(device, glow, &frame);
        let settle = Kernel::new(device, "light::ambient::settle", &[Uniform, Storage, StorageMut]);
        let settle = Run::new(device, settle, &[all(lights), all(&sums), all(&settled)]);
        let sweeps = ["light::ambient::sweep", "light::ambient::shine"].map(|module| {
            let kernel = Kernel::new(device, module, &[Uniform, UniformDynamic, Storage, StorageMut]);
            let slice = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &slices,
                offset: 0,
                size: wgpu::BufferSize::new(16),
            });
            Run::new(device, kernel, &[all(lights), slice, all(&settled), all(&fields)])
        });
        let gathers = ["light::ambient::gather", "light::ambient::collect"].map(|module| {
            let kernel = Kernel::new(device, module, &[Uniform, Storage, StorageMut, Write3d]);
            Run::new(device, kernel, &[all(lights), all(&fields), all(&weights), view()])
        });
        Self { cells, sums, sampler, body_layout, lay, skin, glow, settle, sweeps, gathers, result }
    }

    /// Cells to an edge.
    pub fn cells(&self) -> u32 {
        self.cells
    }

    /// What shaders need to ask for it: the layers and their sampler.
    pub(crate) fn resources(&self) -> [wgpu::BindingResource<'_>; 2] {
        [wgpu::BindingResource::TextureView(&self.result), wgpu::BindingResource::Sampler(&self.sampler)]
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let cell = 4 * CELL_WORDS + 32 + 4 + 8 * u64::from(DIRECTIONS) + 8 * u64::from(LAYERS);
        cell * u64::from(self.cells).pow(3) + STEP * u64::from(self.cells)
    }

    /// The group of a groom.
    pub(crate) fn bind_hair(
        &self,
        device: &wgpu::Device,
        lights: &wgpu::Buffer,
        uniform: &wgpu::Buffer,
        strands: &StrandBuffers,
    ) -> wgpu::BindGroup {
        let buffers = [lights, uniform, &strands.vertices, &strands.strands, &self.sums];
        self.lay.bind(device, &buffers.map(wgpu::Buffer::as_entire_binding))
    }

    /// The group of a body.
    pub(crate) fn bind_body(&self, device: &wgpu::Device, buffers: [&wgpu::Buffer; 3]) -> wgpu::BindGroup {
        group(device, "surface", &self.body_layout, &buffers.map(wgpu::Buffer::as_entire_binding))
    }

    /// Records all of it; after the shadow maps.
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        hair: Option<&HairSet>,
        body: Option<&Body>,
    ) {
        encoder.clear_buffer(&self.sums, 0, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("ambient"),
            timestamp_writes: timings.and_then(|timings| timings.compute("ambient")),
        });
        let pass = &mut pass;
        if let Some(hair) = hair {
            let every = (hair.drawn.count / AMBIENT_STRANDS).max(1);
            let strands = u64::from(hair.drawn.count.div_ceil(every));
            let threads = strands * u64::from(hair.drawn.vertex_count.saturating_sub(1));
            let workgroups = threads.div_ceil(u64::from(STRAND_WORKGROUP)) as u32;
            self.lay.record(pass, &hair.ambient_group, &[], workgroups);
        }
        let cells = self.cells.pow(3);
        let slice = [self.cells.pow(2).div_ceil(STRAND_WORKGROUP), DIRECTIONS, 1];
        for (i, (sweep, gather)) in self.sweeps.iter().zip(&self.gathers).enumerate() {
            if let Some(body) = body {
                pass.set_bind_group(1, &body.surface_group, &[]);
                [&self.skin, &self.glow][i].record(pass, body.surface.points);
            }
            self.settle.record(pass, cells);
            for i in 0..u64::from(self.cells) {
                sweep.kernel.record_grid(pass, &sweep.group, &[(STEP * i) as u32], slice);
            }
            gather.record(pass, cells);
        }
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
