//! Asks for light from all sides at any points: what tests and tools measure it with.

use crate::{
    Result,
    constants::STRAND_WORKGROUP,
    draw::DrawStage,
    gpu::{Binding, Kernel, readback},
    strands::buffers::storage,
};
use glam::{Vec3, Vec4};

/// What arrives at a point from some directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Around {
    /// The share of the sky that arrives where fibres take none, an eighth, half and all of the light that meets
    /// them; bodies take all.
    pub open: Vec4,
    /// The mean radiance of bodies.
    pub glow: Vec3,
}

/// A set of points at which light from all sides is asked for.
#[derive(Debug)]
pub struct AmbientProbe {
    kernel: Kernel,
    group: wgpu::BindGroup,
    answers: wgpu::Buffer,
    count: u32,
}

impl AmbientProbe {
    /// Takes `points` to the GPU, to be asked about in the cells of `stage`: positions (metres), and the mean vector of
    /// the directions that are asked about (0 for all of them, half a unit vector for a hemisphere).
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold them.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        stage: &DrawStage,
        points: &[(Vec3, Vec3)],
    ) -> Result<Self> {
        use Binding::{Comparison, DepthArray, Sampler, Storage, StorageMut, Texture3d, Uniform};
        let entries =
            [Storage, Uniform, DepthArray, Comparison, Storage, Storage, Texture3d, Sampler, StorageMut];
        let kernel = Kernel::new(device, "light::ambient::ask", &entries);
        let count = points.len().max(1) as u64;
        let buffer = storage::<[f32; 8]>(device, "ambient points", count)?;
        let words: Vec<[Vec4; 2]> =
            points.iter().map(|(at, middle)| [at.extend(0.0), middle.extend(0.0)]).collect();
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
        let answers = storage::<[f32; 8]>(device, "ambient answers", count)?;
        let frame = stage.light_resources().into_iter().chain(stage.ambient_resources());
        let resources: Vec<_> = std::iter::once(buffer.as_entire_binding())
            .chain(frame)
            .chain([answers.as_entire_binding()])
            .collect();
        let group = kernel.bind(device, &resources);
        Ok(Self { kernel, group, answers, count: points.len() as u32 })
    }

    /// Asks, after [`DrawStage::shadow`] has been recorded.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.kernel.record(&mut pass, &self.group, &[], self.count.div_ceil(STRAND_WORKGROUP));
    }

    /// The answers.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<Around>> {
        let answers: Vec<[Vec4; 2]> = readback::buffer(device, queue, &self.answers).await?;
        let around = |[open, glow]: [Vec4; 2]| Around { open, glow: glow.truncate() };
        Ok(answers.into_iter().map(around).collect())
    }
}
