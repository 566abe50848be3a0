//! Host side of `peak.wesl`: the largest value of a grid, to choose a range of colours by.

use super::{Grid, constant};
use crate::{
    Result,
    gpu::{Binding, Kernel, readback},
    strands::buffers::storage,
};

/// The pipeline.
#[derive(Debug)]
pub struct Peak(Kernel);

impl Peak {
    /// Builds it.
    pub fn new(device: &wgpu::Device) -> Self {
        Self(Kernel::new(device, "views::peak", &[Binding::Uniform, Binding::Texture3d, Binding::StorageMut]))
    }

    /// The largest value in `grid` as it is now, at least 0. Waits: not for the frame.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn measure(&self, device: &wgpu::Device, queue: &wgpu::Queue, grid: &Grid<'_>) -> Result<f32> {
        let result = storage::<f32>(device, "peak", 1)?;
        let place = constant(device, "peak", &grid.uniform());
        let group = self.0.bind(
            device,
            &[
                place.as_entire_binding(),
                wgpu::BindingResource::TextureView(grid.texture),
                result.as_entire_binding(),
            ],
        );
        let mut encoder = device.create_command_encoder(&Default::default());
        self.0.record(&mut crate::gpu::compute_pass(&mut encoder, &Default::default()), &group, &[], 1);
        queue.submit([encoder.finish()]);
        Ok(readback::buffer::<f32>(device, queue, &result).await?[0])
    }
}
