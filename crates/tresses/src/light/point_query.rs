//! Evaluates a kernel at a set of points and reads the results back.

use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{Bindings, Kernel, readback},
    strands::buffers::storage,
};
use bytemuck::Pod;
use glam::Vec4;

/// Points on the GPU, the kernel to evaluate at them, and a buffer for one result `A` per point.
#[derive(Debug)]
pub(super) struct PointQuery<A> {
    context: Context,
    kernel: Kernel,
    group: wgpu::BindGroup,
    results: wgpu::Buffer,
    points: u32,
    result: std::marker::PhantomData<A>,
}

impl<A: Pod> PointQuery<A> {
    /// Uploads `words`, which describe `points` points, for the kernel of `B`. `bind` creates its bind group for the
    /// words and the results.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold the buffers.
    pub(super) fn new<B: Bindings>(
        context: &Context,
        words: &[Vec4],
        points: usize,
        bind: impl FnOnce(&Kernel, &wgpu::Buffer, &wgpu::Buffer) -> wgpu::BindGroup,
    ) -> Result<Self> {
        let Context { device, queue, .. } = context;
        let kernel = Kernel::new::<B>(device);
        let buffer = storage::<Vec4>(device, "points", words.len().max(1) as u64)?;
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
        let results = storage::<A>(device, "answers", points.max(1) as u64)?;
        let group = bind(&kernel, &buffer, &results);
        Ok(Self {
            context: context.clone(),
            kernel,
            group,
            results,
            points: points as u32,
            result: std::marker::PhantomData,
        })
    }

    /// Records the evaluation. Call it after the passes that write its inputs.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the kernel cannot be compiled.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        let mut commands = self.context.commands(encoder);
        let mut pass = commands.compute("probe");
        self.kernel.record(&mut pass, &self.group, &[], self.points.div_ceil(STRAND_WORKGROUP));
        pass.end()
    }

    /// Reads the results back, in the order of the points.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub(super) async fn read(&self) -> Result<Vec<A>> {
        let mut results = readback::buffer(&self.context, &self.results).await?;
        results.truncate(self.points as usize);
        Ok(results)
    }
}
