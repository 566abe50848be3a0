//! Host side of `peak.wesl`: the largest value of a grid, for the choice of a color range.

use super::{GridView, constant};
use crate::{
    Context, Result,
    gpu::{BindBuffer, Kernel, readback},
    shaders::kernels::views as kernels,
    strands::buffers::storage,
};

/// Kernel that finds the largest value of a grid.
#[derive(Debug)]
pub struct Peak {
    context: Context,
    kernel: Kernel,
}

impl Peak {
    /// Creates the kernel.
    pub fn new(context: &Context) -> Self {
        Self { context: context.clone(), kernel: Kernel::new::<kernels::Peak>(&context.device) }
    }

    /// Returns the current largest value of `grid`, at least 0. It waits for the GPU, so do not use it in every frame.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn measure(&self, grid: &GridView<'_>) -> Result<f32> {
        let result = storage::<f32>(&self.context.device, "peak", 1)?;
        let grid_uniform = constant(&self.context.device, "peak", &grid.uniform());
        let group = self.kernel.bind(&kernels::Peak {
            grid: grid_uniform.entire(),
            values: grid.texture,
            result: result.entire(),
        });
        let mut encoder = self.context.device.create_command_encoder(&Default::default());
        let mut commands = self.context.commands(&mut encoder);
        let mut pass = commands.compute("peak");
        self.kernel.record(&mut pass, &group, &[], 1);
        pass.end()?;
        self.context.queue.submit([encoder.finish()]);
        Ok(readback::buffer::<f32>(&self.context, &result).await?[0])
    }
}
