//! Textures of the air, and the dispatches that advect it.

use super::{
    params::WindUniforms,
    pipelines::{Dispatch, Pipelines},
};
use crate::{
    gpu::{BindBuffer, Device, Uniform, grid::grid_texture},
    shaders::kernels::wind as kernels,
};
use wgpu::{TextureFormat, TextureView};

/// Textures with a texel per cell.
#[derive(Debug)]
pub(super) struct Grids {
    pub center: TextureView,
    pub faces: TextureView,
    pub give: TextureView,
    pub among: TextureView,
    pub before: TextureView,
    pub hair: TextureView,
    advected: TextureView,
    solid: TextureView,
    /// Bytes of GPU memory.
    pub bytes: u64,
}

/// The dispatches before the pressure solve.
#[derive(Debug)]
pub(super) struct Advection {
    /// Once per step.
    pub obstacles: Dispatch,
    /// Once per part of a step.
    pub air: [Dispatch; 2],
}

/// Creates a texture of the air, and adds its bytes to `bytes`.
pub(super) fn view(
    device: &Device,
    label: &'static str,
    format: TextureFormat,
    size: [u32; 3],
    bytes: &mut u64,
) -> TextureView {
    *bytes += u64::from(size.iter().product::<u32>()) * u64::from(format.block_copy_size(None).unwrap_or(0));
    grid_texture(device, label, format, size).1
}

impl Grids {
    /// Creates textures for `cells` cells along each axis.
    pub fn new(device: &Device, cells: u32) -> Self {
        use wgpu::TextureFormat::{Rgba16Float, Rgba32Float};
        let mut bytes = 0;
        let mut view = |label, format| view(device, label, format, [cells; 3], &mut bytes);
        Self {
            center: view("air", Rgba16Float),
            faces: view("air on faces", Rgba16Float),
            give: view("air give", Rgba16Float),
            advected: view("air carried", Rgba16Float),
            before: view("air before pressure", Rgba32Float),
            solid: view("air solid", Rgba16Float),
            hair: view("air hair", Rgba16Float),
            among: view("air among hair", Rgba16Float),
            bytes,
        }
    }

    /// Binds the kernels before the pressure solve. [`Air::new`](super::Air::new) describes `hair_grid`.
    pub fn advection(
        &self,
        pipelines: &Pipelines,
        uniforms: &Uniform,
        hair_grid: &TextureView,
        cells: u32,
    ) -> Advection {
        let Self { center, faces: now, give, advected, before, solid, hair, .. } = self;
        let (u, linear_sampler) =
            (uniforms.part(0, Some(size_of::<WindUniforms>() as u64)), &pipelines.sampler);
        let air = kernels::Air { u, now, center, linear_sampler };
        let obstacles = kernels::Obstacles { u, hair_grid, linear_sampler, solid, hair };
        let predict = kernels::Predict { air, advected };
        let correct = kernels::Correct { air, advected, solid, hair, before, give };
        let workgroups = [cells / 8, cells / 4, cells / 2];
        let dispatch = |kernel, group| Dispatch { kernel, group, workgroups, is_stepped: true };
        Advection {
            obstacles: dispatch(|all| &all.obstacles, pipelines.obstacles.bind(&obstacles)),
            air: [
                dispatch(|all| &all.predict, pipelines.predict.bind(&predict)),
                dispatch(|all| &all.correct, pipelines.correct.bind(&correct)),
            ],
        }
    }
}
