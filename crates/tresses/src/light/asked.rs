//! Evaluates a kernel at a set of points and reads the results back.

use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Kernel, readback},
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
    answers: wgpu::Buffer,
    points: u32,
    answer: std::marker::PhantomData<A>,
}

impl<A: Pod> PointQuery<A> {
    /// Uploads `words`, which describe `points` points. The kernel in `module` binds them, then the `frame` resources
    /// (with their layouts), then the results.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold the buffers.
    pub(super) fn new<'a>(
        context: &Context,
        module: &'static str,
        (words, points): (&[Vec4], usize),
        frame: impl IntoIterator<Item = (Binding, wgpu::BindingResource<'a>)>,
    ) -> Result<Self> {
        let Context { device, queue, .. } = context;
        let buffer = storage::<Vec4>(device, module, words.len().max(1) as u64)?;
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
        let answers = storage::<A>(device, module, points.max(1) as u64)?;
        let (mut entries, mut resources) = (vec![Binding::Storage], vec![buffer.as_entire_binding()]);
        for (entry, resource) in frame {
            entries.push(entry);
            resources.push(resource);
        }
        entries.push(Binding::StorageMut);
        resources.push(answers.as_entire_binding());
        let kernel = Kernel::new(&context.device, module, &entries);
        let group = kernel.bind(&resources);
        Ok(Self {
            context: context.clone(),
            kernel,
            group,
            answers,
            points: points as u32,
            answer: std::marker::PhantomData,
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
        let mut answers = readback::buffer(&self.context, &self.answers).await?;
        answers.truncate(self.points as usize);
        Ok(answers)
    }
}
