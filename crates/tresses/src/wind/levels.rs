//! The pressure on a GPU: one cycle of multigrid.

use super::{
    grids::Grids,
    params::AirLevel,
    pipelines::{Dispatch, Pipelines, PressureSolve},
};
use crate::{
    Context,
    gpu::{BindBuffer, Buffer, bindings::constant},
    shaders::kernels::wind as kernels,
};

/// Maximum cells along an axis of the coarsest level, which one workgroup solves.
const COARSEST: u32 = 16;
/// Cells along an edge of a workgroup's tile.
const TILE: u32 = 8;
/// Cycles of a step that starts anew: an odd number, because each reads the pressures that the previous one wrote.
const FRESH_CYCLES: u32 = 3;

/// One level of the multigrid.
#[derive(Debug)]
struct Level {
    /// Cells along an axis.
    cells: u32,
    equations: Buffer<[u32; 4]>,
    /// Pressures before and after smoothing.
    pressures: [Buffer<f32>; 2],
}

impl Level {
    fn new(context: &Context, cells: u32) -> Self {
        let count = u64::from(cells).pow(3);
        let buffer = |label, bytes| {
            context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        };
        Self {
            cells,
            equations: buffer("air equations", 16 * count).into(),
            pressures: [(); 2].map(|()| buffer("air level", 4 * count).into()),
        }
    }

    fn bytes(&self) -> u64 {
        self.equations.size() + 2 * self.pressures[0].size()
    }
}

/// Creates the levels, and binds the kernels for `cells` cells along each axis.
pub(super) fn solve(context: &Context, pipelines: &Pipelines, grids: &Grids, cells: u32) -> PressureSolve {
    let levels: Vec<_> = sizes(cells).into_iter().map(|cells| Level::new(context, cells)).collect();
    let bind = Binder { context, pipelines, grids, levels: &levels };
    PressureSolve {
        steady: bind.cycles(1, true),
        fresh: bind.cycles(FRESH_CYCLES, false),
        bytes: levels.iter().map(Level::bytes).sum(),
    }
}

/// Returns the cells along an axis of each level, at least two levels, the finest first.
fn sizes(cells: u32) -> Vec<u32> {
    let mut sizes = vec![cells, cells / 2];
    while let Some(last) = sizes.last().filter(|last| **last > COARSEST) {
        sizes.push(last / 2);
    }
    sizes
}

/// Binds kernels to levels.
struct Binder<'a> {
    context: &'a Context,
    pipelines: &'a Pipelines,
    grids: &'a Grids,
    levels: &'a [Level],
}

impl Binder<'_> {
    /// Returns the dispatches of `count` cycles, an odd number. The first one starts from the last step's pressures if
    /// `keeps`.
    fn cycles(&self, count: u32, keeps: bool) -> Vec<Dispatch> {
        let coarsest = self.levels.len() - 1;
        let mut dispatches = Vec::new();
        for cycle in 0..count {
            let is_first = u32::from(cycle == 0);
            let finest = AirLevel {
                gathers: is_first,
                keeps: u32::from(keeps || cycle > 0),
                corrects: 1 - is_first,
                restricts: 1,
                ..AirLevel::default()
            };
            dispatches.push(self.smooth(0, cycle as usize % 2, finest));
            let down = AirLevel { restricts: 1, ..AirLevel::default() };
            dispatches.extend((1..coarsest).map(|level| self.smooth(level, 1, down)));
            dispatches.push(self.coarse_solve());
            let up = AirLevel { keeps: 1, corrects: 1, ..AirLevel::default() };
            dispatches.extend((1..coarsest).rev().map(|level| self.smooth(level, 0, up)));
        }
        dispatches.push(self.project());
        dispatches
    }

    /// Binds a smoothing of `level`, from its pressures `from` to the others.
    fn smooth(&self, level: usize, from: usize, what: AirLevel) -> Dispatch {
        let Grids { before, give, .. } = self.grids;
        let uniform = self.uniform(level, what);
        let tile = self.tile(&uniform, level, from);
        let coarser_equations = self.levels[level + 1].equations.entire();
        let bindings = kernels::SmoothLevel { tile, before, give, coarser_equations };
        let group = self.pipelines.smooth_level.bind(&bindings);
        self.tiled(|all| &all.smooth_level, group, level)
    }

    fn coarse_solve(&self) -> Dispatch {
        let level = self.levels.len() - 1;
        let uniform = self.uniform(level, AirLevel::default());
        let group =
            self.pipelines.coarse_solve.bind(&kernels::CoarseSolve { tile: self.tile(&uniform, level, 1) });
        Dispatch { kernel: |all| &all.coarse_solve, group, workgroups: [1; 3], is_stepped: false }
    }

    fn project(&self) -> Dispatch {
        let Grids { before, faces: now, center, hair, among, .. } = self.grids;
        let what = AirLevel { keeps: 1, corrects: 1, ..AirLevel::default() };
        let uniform = self.uniform(0, what);
        let tile = self.tile(&uniform, 0, 1);
        let bindings = kernels::SmoothProject { tile, before, now, center, hair, among };
        let group = self.pipelines.smooth_project.bind(&bindings);
        self.tiled(|all| &all.smooth_project, group, 0)
    }

    fn tiled(
        &self,
        kernel: fn(&Pipelines) -> &crate::gpu::Kernel,
        group: wgpu::BindGroup,
        level: usize,
    ) -> Dispatch {
        let tiles = self.levels[level].cells.div_ceil(TILE);
        Dispatch { kernel, group, workgroups: [tiles; 3], is_stepped: false }
    }

    fn uniform(&self, level: usize, what: AirLevel) -> wgpu::Buffer {
        let cells = self.levels[level].cells;
        let coarse = self.levels.get(level + 1).map_or(0, |level| level.cells);
        let inside = if level == 0 { cells - 1 } else { cells };
        constant(&self.context.device, "air level uniform", &AirLevel { cells, inside, coarse, ..what })
    }

    /// Binds `level` with its pressures `from`, and the solution of the next coarser level.
    fn tile<'a>(&'a self, uniform: &'a wgpu::Buffer, level: usize, from: usize) -> kernels::Tile<'a> {
        let Level { equations, pressures, .. } = &self.levels[level];
        let coarsest = self.levels.len() - 1;
        let next = (level + 1).min(coarsest);
        // `coarse_solve` writes the first pressures of its level, the last smoothing of a level the second.
        let solution = &self.levels[next].pressures[usize::from(next < coarsest)];
        kernels::Tile {
            level: uniform.entire(),
            old: pressures[from].entire(),
            better: pressures[1 - from].entire(),
            equations: equations.entire(),
            coarser: solution.entire(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        gpu::{Tier, grid::grid_texture, noop},
        wind::{
            Air,
            params::{MAX_CELLS, MIN_CELLS},
        },
    };
    use glam::Vec3;

    /// A free slot is reused, so its values would change.
    #[test]
    fn kernels_read_no_slot_that_is_free() {
        for software in [true, false] {
            let context = noop();
            let context = context.clone().with_tier(Tier { software, ..context.tier() });
            let hair = grid_texture(&context.device, "hair", wgpu::TextureFormat::Rgba16Float, [1; 3]).1;
            let _air = Air::new(&context, 32, (Vec3::ZERO, 1.0), &hair).unwrap();
            assert_eq!(context.device.uniforms.free_slots(), 0, "software: {software}");
            drop(context.device.uniform(16));
            assert_eq!(context.device.uniforms.free_slots(), 1);
        }
    }

    /// Pairs of cells make up the next level, and the coarsest fits into one workgroup.
    #[test]
    fn levels_halve_their_cells() {
        for cells in (MIN_CELLS..=MAX_CELLS).step_by(8) {
            let sizes = sizes(cells);
            assert!(sizes.windows(2).all(|pair| pair[0] == 2 * pair[1]), "{sizes:?}");
            assert!(sizes.len() >= 2 && sizes[sizes.len() - 1] <= COARSEST, "{sizes:?}");
        }
    }
}
