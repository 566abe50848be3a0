//! The pressure on a software driver: block relaxation of textures.

use super::{
    grids::{Grids, view},
    params::{HalfSweep, WindUniforms},
    pipelines::{Dispatch, Pipelines, PressureSolve},
};
use crate::{
    Context,
    gpu::{BindBuffer, Uniform, bindings::constant},
    shaders::kernels::wind as kernels,
};
use bytemuck::Zeroable;
use wgpu::TextureFormat::{Rgba16Float, Rgba32Float};

/// Sweeps per step with 32 cells along an axis.
const SWEEPS: usize = 8;

/// Creates the textures, and binds the kernels for `cells` cells along each axis.
pub(super) fn solve(
    context: &Context,
    pipelines: &Pipelines,
    uniforms: &Uniform,
    grids: &Grids,
    cells: u32,
) -> PressureSolve {
    let Grids { center, faces: now, give, among, before, hair, .. } = grids;
    let mut bytes = 0;
    let mut view = |label, format, size| view(&context.device, label, format, size, &mut bytes);
    // Give on the faces along each axis.
    let rimmed = [cells / 4 + 1, cells + 1, cells + 1];
    let gives = ["air give x", "air give y", "air give z"].map(|label| view(label, Rgba16Float, rimmed));
    let source = &view("air source", Rgba32Float, [cells / 4, cells, cells]);
    // Indexed by sweep (even, odd), then by half.
    let half = [cells / 8 + 2, cells + 2, cells + 2];
    let pressures =
        [(); 2].map(|()| ["air pressure a", "air pressure b"].map(|label| view(label, Rgba32Float, half)));
    let [give_x, give_y, give_z] = &gives;
    let u = uniforms.part(0, Some(size_of::<WindUniforms>() as u64));
    let half_of = |half: HalfSweep| constant(&context.device, "air half", &half);
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
    let gather = kernels::Gather { u, before, give, give_x, give_y, give_z, source };
    let gather = pipelines.gather.bind(&gather);
    let relax = Sweep::ALL.map(|sweep| [relax(sweep, 0), relax(sweep, 1)]);
    let project = [project(0), project(1)];
    let dispatches = |fresh| {
        let dispatch = |kernel, group: &wgpu::BindGroup, workgroups| Dispatch {
            kernel,
            group: group.clone(),
            workgroups,
            is_stepped: true,
        };
        let half = [cells.div_ceil(32), cells / 8, cells / 2];
        let gather = dispatch(|all| &all.gather, &gather, [cells.div_ceil(32), cells / 4, cells / 2]);
        let sweeps = sweeps(cells, fresh).flat_map(|sweep| &relax[sweep as usize]);
        std::iter::once(gather)
            .chain(sweeps.map(|group| dispatch(|all| &all.relax, group, half)))
            .chain(project.iter().map(|group| dispatch(|all| &all.project, group, half)))
            .collect()
    };
    PressureSolve { steady: dispatches(false), fresh: dispatches(true), bytes }
}

/// Returns the sweeps of the pressure, an even number, because each reads the texture that the previous one wrote.
/// Larger grids need more, for information to cross the grid.
fn sweeps(cells: u32, fresh: bool) -> impl Iterator<Item = Sweep> {
    let sweeps = 2 * (cells as usize * SWEEPS).div_ceil(64).max(2);
    let sweeps = if fresh { 4 * sweeps } else { sweeps };
    (0..sweeps).map(move |i| match i {
        0 if fresh => Sweep::First,
        i if i + 1 == sweeps => Sweep::Last,
        i if i + 2 == sweeps => Sweep::Slowing,
        i if i % 2 == 0 => Sweep::Even,
        _ => Sweep::Odd,
    })
}

/// A sweep of the pressure relaxation; it determines textures, known pressures and over-relaxation. Strong
/// over-relaxation comes first: it spreads the smooth part of the error over the grid but leaves it rough. Weaker
/// over-relaxation then smooths it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sweep {
    /// First sweep after a restart: the pressures are unknown.
    First,
    Even,
    Odd,
    /// Last sweep but one.
    Slowing,
    Last,
}

impl Sweep {
    const ALL: [Self; 5] = [Self::First, Self::Even, Self::Odd, Self::Slowing, Self::Last];

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
