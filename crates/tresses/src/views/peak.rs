//! Host side of `peak.wesl`: the largest value of a grid, to choose a range of colours by.

use super::{Grid, constant};
use crate::{
    Context, Result,
    gpu::{Binding, Kernel, readback},
    strands::buffers::storage,
};

/// The pipeline.
#[derive(Debug)]
pub struct Peak {
    context: Context,
    kernel: Kernel,
}

impl Peak {
    /// Builds it.
    pub fn new(context: &Context) -> Self {
        Self {
            context: context.clone(),
            kernel: Kernel::new(
                &context.device,
                "views::peak",
                &[Binding::Uniform, Binding::Texture3d, Binding::StorageMut],
            ),
        }
    }

    /// The largest value in `grid` as it is now, at least 0. Waits: not for the frame.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn measure(&self, grid: &Grid<'_>) -> Result<f32> {
        let result = storage::<f32>(&self.context.device, "peak", 1)?;
        let place = constant(&self.context.device, "peak", &grid.uniform());
        let group = self.kernel.bind(&[
            place.as_entire_binding(),
            wgpu::BindingResource::TextureView(grid.texture),
            result.as_entire_binding(),
        ]);
        let mut encoder = self.context.device.create_command_encoder(&Default::default());
        let mut commands = self.context.commands(&mut encoder);
        let mut pass = commands.compute("peak");
        self.kernel.record(&mut pass, &group, &[], 1);
        pass.end()?;
        self.context.queue.submit([encoder.finish()]);
        Ok(readback::buffer::<f32>(&self.context, &result).await?[0])
    }
}
