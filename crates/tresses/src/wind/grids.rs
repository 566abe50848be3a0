//! Textures of the air, and the bind groups of the kernels that read and write them.

use super::{
    Pipelines,
    params::{HalfSweep, WindUniforms},
};
use crate::{
    Context,
    gpu::{BindBuffer, Device, bindings::uniform_buffer, grid::grid_texture},
    shaders::kernels::wind as kernels,
};
use bytemuck::Zeroable;
use wgpu::TextureView;

/// Bind groups of the kernels.
#[derive(Debug)]
pub(super) struct Groups {
    pub obstacles: wgpu::BindGroup,
    pub predict: wgpu::BindGroup,
    pub correct: wgpu::BindGroup,
    pub gather: wgpu::BindGroup,
    /// Indexed by [`Sweep`] and half.
    pub relax: [[wgpu::BindGroup; 2]; Sweep::ALL.len()],
    /// Indexed by half.
    pub project: [wgpu::BindGroup; 2],
}

/// The textures.
#[derive(Debug)]
pub(super) struct Grids {
    pub center: TextureView,
    pub faces: TextureView,
    pub give: TextureView,
    pub among: TextureView,
    advected: TextureView,
    before: TextureView,
    solid: TextureView,
    hair: TextureView,
    /// Give on the faces along each axis.
    gives: [TextureView; 3],
    source: TextureView,
    /// Indexed by sweep (even, odd), then by half.
    pressures: [[TextureView; 2]; 2],
    /// Bytes of GPU memory.
    pub bytes: u64,
}

impl Grids {
    /// Creates textures for `cells` cells along each axis.
    pub fn new(device: &Device, cells: u32) -> Self {
        use wgpu::TextureFormat::{Rgba16Float, Rgba32Float};
        let mut bytes = 0;
        let mut view = |label, format: wgpu::TextureFormat, size: [u32; 3]| {
            bytes += u64::from(size.iter().product::<u32>())
                * u64::from(format.block_copy_size(None).unwrap_or(0));
            grid_texture(device, label, format, size).1
        };
        let all = [cells; 3];
        let rimmed = [cells / 4 + 1, cells + 1, cells + 1];
        let half = [cells / 8 + 2, cells + 2, cells + 2];
        Self {
            center: view("air", Rgba16Float, all),
            faces: view("air on faces", Rgba16Float, all),
            give: view("air give", Rgba16Float, all),
            advected: view("air carried", Rgba16Float, all),
            before: view("air before pressure", Rgba32Float, all),
            solid: view("air solid", Rgba16Float, all),
            hair: view("air hair", Rgba16Float, all),
            gives: ["air give x", "air give y", "air give z"].map(|label| view(label, Rgba16Float, rimmed)),
            among: view("air among hair", Rgba16Float, all),
            source: view("air source", Rgba32Float, [cells / 4, cells, cells]),
            pressures: [(); 2]
                .map(|()| ["air pressure a", "air pressure b"].map(|label| view(label, Rgba32Float, half))),
            bytes,
        }
    }

    /// Binds the kernels. [`Air::new`](super::Air::new) describes `hair_grid`.
    pub fn bind(
        &self,
        context: &Context,
        pipelines: &Pipelines,
        uniforms: &wgpu::Buffer,
        hair_grid: &TextureView,
    ) -> Groups {
        let Self { center, faces: now, give, among, advected, before, solid, hair, .. } = self;
        let Self { source, pressures, .. } = self;
        let [give_x, give_y, give_z] = &self.gives;
        let (u, linear_sampler) =
            (uniforms.part(0, Some(size_of::<WindUniforms>() as u64)), &pipelines.sampler);
        let half_of = |half: HalfSweep| {
            let buffer = uniform_buffer(&context.device, "air half", size_of::<HalfSweep>());
            context.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(&half));
            buffer
        };
        let relax = |sweep: Sweep, color: usize| {
            let odd = sweep.odd();
            let half = half_of(sweep.half(color));
            let own = &pressures[odd][color];
            // The first half reads the other half's pressures from the last sweep, the second half those that the first
            // has just written.
            let other = if color == 0 { &pressures[odd][1] } else { &pressures[1 - odd][0] };
            let blocks = kernels::Blocks { u, half_of: half.entire(), give_x, give_y, give_z, own, other };
            let better = &pressures[1 - odd][color];
            pipelines.relax.bind(&kernels::Relax { blocks, source, better })
        };
        let project = |color: usize| {
            let half = half_of(HalfSweep { color: color as u32, ..Zeroable::zeroed() });
            let (own, other) = (&pressures[0][color], &pressures[0][1 - color]);
            let blocks = kernels::Blocks { u, half_of: half.entire(), give_x, give_y, give_z, own, other };
            pipelines.project.bind(&kernels::Project { blocks, before, now, center, hair, among })
        };
        let air = kernels::Air { u, now, center, linear_sampler };
        let obstacles = kernels::Obstacles { u, hair_grid, linear_sampler, solid, hair };
        let correct = kernels::Correct { air, advected, solid, hair, before, give };
        let gather = kernels::Gather { u, before, give, give_x, give_y, give_z, source };
        Groups {
            obstacles: pipelines.obstacles.bind(&obstacles),
            predict: pipelines.predict.bind(&kernels::Predict { air, advected }),
            correct: pipelines.correct.bind(&correct),
            gather: pipelines.gather.bind(&gather),
            relax: Sweep::ALL.map(|sweep| [relax(sweep, 0), relax(sweep, 1)]),
            project: [project(0), project(1)],
        }
    }
}

/// A sweep of the pressure relaxation; it determines textures, known pressures and over-relaxation. Strong
/// over-relaxation comes first: it spreads the smooth part of the error over the grid but leaves it rough. Weaker
/// over-relaxation then smooths it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sweep {
    /// First sweep after a restart: the pressures are unknown.
    First,
    Even,
    Odd,
    /// Last sweep but one.
    Slowing,
    Last,
}

impl Sweep {
    pub const ALL: [Self; 5] = [Self::First, Self::Even, Self::Odd, Self::Slowing, Self::Last];

    /// Returns 1 if the sweep reads the output of an even sweep, else 0.
    fn odd(self) -> usize {
        usize::from(matches!(self, Self::Odd | Self::Last))
    }

    /// Returns the uniforms for half `color`.
    fn half(self, color: usize) -> HalfSweep {
        let (first, second) = (self == Self::First, color == 1);
        let relaxation = match self {
            Self::First | Self::Even | Self::Odd => 1.7,
            Self::Slowing => 1.3,
            Self::Last => 1.0,
        };
        HalfSweep {
            color: color as u32,
            keep_own: if first { 0.0 } else { 1.0 },
            // The second half reads the output of the first.
            keep_other: if first && !second { 0.0 } else { 1.0 },
            relaxation,
        }
    }
}
