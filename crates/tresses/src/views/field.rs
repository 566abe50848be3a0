//! Host side of `field.wesl`: the distance to obstacles, as a grid for slices.

use super::{Canvas, GridView};
use crate::{
    Context, Result,
    collide::{self, ColliderSet},
    gpu::{BindBuffer, Kernel},
    shaders::kernels::views as kernels,
};

/// Texels along each edge.
const RESOLUTION: u32 = 96;

/// The kernel and the grid that it fills.
#[derive(Debug)]
pub(super) struct FieldKernel {
    kernel: Kernel,
    pub(super) texture: wgpu::TextureView,
}

impl FieldKernel {
    pub(super) fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("distances"),
            size: wgpu::Extent3d { width: RESOLUTION, height: RESOLUTION, depth_or_array_layers: RESOLUTION },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let obstacles = collide::layout(device);
        Self {
            kernel: Kernel::with_shared::<kernels::Field>(&context.device, &[&obstacles]),
            texture: texture.create_view(&Default::default()),
        }
    }

    /// Fills the grid with the distances in the box of `grid`, meters.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        grid: &GridView<'_>,
        colliders: &ColliderSet,
    ) -> Result<()> {
        let grid_uniform = canvas.grid(grid);
        let group =
            self.kernel.bind(&kernels::Field { grid: grid_uniform.entire(), distances: &self.texture });
        let mut pass = canvas.commands.compute("debug");
        pass.set_bind_group(1, colliders.group(), &[]);
        self.kernel.record_grid(&mut pass, &group, &[], [RESOLUTION.div_ceil(4); 3]);
        pass.end()
    }
}
