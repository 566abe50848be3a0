//! Asks the shadow maps about any points: what tests and tools measure shadows with.

use super::MAX_LIGHTS;
use crate::{
    Result,
    constants::STRAND_WORKGROUP,
    draw::DrawStage,
    gpu::{Binding, Kernel, readback},
    strands::buffers::storage,
};
use glam::{Vec3, Vec4};

/// What is between a point and a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shadow {
    /// The mean number of fibres: -ln of the share of the light that meets none.
    pub fibers: f32,
    /// The share of the light that no body keeps away.
    pub solid: f32,
}

/// A set of points that the shadow maps are asked about.
#[derive(Debug)]
pub struct ShadowProbe {
    kernel: Kernel,
    group: wgpu::BindGroup,
    answers: wgpu::Buffer,
    count: u32,
}

impl ShadowProbe {
    /// Takes `points` (metres, at most four million) to the GPU, to be asked about in the maps of `stage`: as
    /// points that are seen from afar in the direction `eye` (unit), or, without, as any points of the hair.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold them.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        stage: &DrawStage,
        points: &[Vec3],
        eye: Option<Vec3>,
    ) -> Result<Self> {
        use Binding::{Comparison, DepthArray, Storage, StorageMut, Uniform};
        let entries = [Storage, Uniform, DepthArray, Comparison, Storage, Storage, StorageMut];
        let kernel = Kernel::new(device, "light::probe", &entries);
        let count = points.len().max(1);
        let buffer = storage::<[f32; 4]>(device, "probe points", 1 + count as u64)?;
        let eye = eye.map_or(Vec4::ZERO, |eye| eye.extend(1.0));
        let positions: Vec<_> =
            std::iter::once(eye).chain(points.iter().map(|point| point.extend(0.0))).collect();
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&positions));
        let answers = storage::<[f32; 2]>(device, "probe answers", (count * MAX_LIGHTS) as u64)?;
        let [lights, maps, comparison, hair, blocks] = stage.light_resources();
        let resources =
            [buffer.as_entire_binding(), lights, maps, comparison, hair, blocks, answers.as_entire_binding()];
        let group = kernel.bind(device, &resources);
        Ok(Self { kernel, group, answers, count: count as u32 })
    }

    /// Asks, after [`DrawStage::shadow`] has been recorded.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.kernel.record(&mut pass, &self.group, &[], self.count.div_ceil(STRAND_WORKGROUP));
    }

    /// The answers, for each point those of the lights that are on, in their order.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<Vec<[Shadow; MAX_LIGHTS]>> {
        let answers: Vec<[[f32; 2]; MAX_LIGHTS]> = readback::buffer(device, queue, &self.answers).await?;
        let shadow = |[fibers, solid]: [f32; 2]| Shadow { fibers, solid };
        Ok(answers.into_iter().map(|lights| lights.map(shadow)).collect())
    }
}
