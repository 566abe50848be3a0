//! Commands of a frame: an encoder, the timings of its passes, and counts of recorded commands.
//!
//! Passes, dispatches, draws, pipeline changes and bind groups have a cost on every driver, whatever they do, so they
//! are counted. That takes a few additions per pass. [`Timings::counts`](super::Timings::counts) assigns the counts to
//! the rows of the frame.
//!
//! A compute pass stores the first error of the kernels recorded in it and returns it when it [ends](ComputePass::end).
//!
//! **One pass for several.** A compute pass of wgpu has two command buffers of its own, and on Metal an encoder, which
//! costs 5 to 15 µs. While commands [merge](Commands::set_merging) and no pass has timestamps, a compute pass therefore
//! continues the previous one.

use super::{
    Context, Timings,
    counts::Counts,
    probe::{GROUP, Groups},
};
use crate::{Error, Result, stage::Stage};
use std::ops::Range;

/// Records commands into the caller's encoder, see [`Context::commands`].
#[derive(Debug)]
pub struct Commands<'a> {
    context: Context,
    encoder: &'a mut wgpu::CommandEncoder,
    timings: Option<&'a mut Timings>,
    /// Commands recorded since the last lap.
    counts: Counts,
    /// Whether the last command was a transfer.
    transfers: bool,
    /// First error that no pass has returned yet.
    error: Option<Error>,
    /// Whether a compute pass continues the previous one.
    merges: bool,
    /// The pass that the next compute pass continues. The encoder is locked meanwhile.
    open: Option<wgpu::ComputePass<'static>>,
}

/// A compute pass that counts its commands.
#[derive(Debug)]
#[must_use = "`end` returns the errors of a pass"]
pub struct ComputePass<'a> {
    /// `None` only while it is dropped.
    pass: Option<wgpu::ComputePass<'static>>,
    /// Context whose uniforms the end of the pass flushes, unless passes merge.
    flushes: Option<&'a Context>,
    counts: &'a mut Counts,
    error: &'a mut Option<Error>,
    groups: Groups,
    /// Where the pass is kept when it ends, if the next one may continue it.
    open: Option<&'a mut Option<wgpu::ComputePass<'static>>>,
}

/// A render pass that counts its commands.
#[derive(Debug)]
pub(crate) struct RenderPass<'a> {
    pass: wgpu::RenderPass<'a>,
    /// As for a [`ComputePass`].
    flushes: Option<&'a Context>,
    counts: &'a mut Counts,
    groups: Groups,
}

impl Context {
    /// Records commands into `encoder`. After an error the encoder must not be submitted.
    pub fn commands<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> Commands<'a> {
        let (timings, counts, error) = (None, Counts::default(), None);
        let (transfers, merges, open) = (false, false, None);
        Commands { context: self.clone(), encoder, timings, counts, transfers, error, merges, open }
    }
}

impl<'a> Commands<'a> {
    /// Measures the passes with `timings`.
    pub fn with_timings(self, timings: impl Into<Option<&'a mut Timings>>) -> Self {
        Self { timings: timings.into(), ..self }
    }

    /// The context of these commands.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// The encoder.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.open = None;
        self.encoder
    }

    /// Sets whether a compute pass continues the previous one, and returns the former value. Merging must be off when
    /// the encoder is finished: uniforms are flushed when it ends.
    pub(crate) fn set_merging(&mut self, merges: bool) -> bool {
        if !merges {
            self.open = None;
            self.context.flush_uniforms();
        }
        std::mem::replace(&mut self.merges, merges)
    }

    /// Begins a compute pass, timed as `name`.
    pub fn compute(&mut self, name: &'static str) -> ComputePass<'_> {
        let timings = self.timings.as_deref_mut();
        let timestamp_writes = timings.and_then(|timings| timings.compute(name));
        let keeps = self.merges && timestamp_writes.is_none();
        let pass = self.open.take().unwrap_or_else(|| {
            self.counts.passes += 1;
            self.transfers = false;
            let descriptor = wgpu::ComputePassDescriptor { label: Some(name), timestamp_writes };
            self.encoder.begin_compute_pass(&descriptor).forget_lifetime()
        });
        ComputePass {
            pass: Some(pass),
            flushes: (!self.merges).then_some(&self.context),
            counts: &mut self.counts,
            error: &mut self.error,
            groups: Groups::new(self.context.device.probe.as_ref()),
            open: keeps.then_some(&mut self.open),
        }
    }

    /// Begins a render pass, timed as `name`.
    pub(crate) fn render(
        &mut self,
        name: &'static str,
        color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    ) -> RenderPass<'_> {
        self.open = None;
        let timings = self.timings.as_deref_mut();
        let descriptor = wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments,
            depth_stencil_attachment,
            timestamp_writes: timings.and_then(|timings| timings.render(name)),
            ..Default::default()
        };
        self.counts += Counts { passes: 1, bytes: attached(&descriptor), ..Counts::default() };
        self.transfers = false;
        RenderPass {
            pass: self.encoder.begin_render_pass(&descriptor),
            flushes: (!self.merges).then_some(&self.context),
            counts: &mut self.counts,
            groups: Groups::new(self.context.device.probe.as_ref()),
        }
    }

    /// Fills the first `size` bytes of a buffer with zeros, or all of it.
    pub(crate) fn clear(&mut self, buffer: &wgpu::Buffer, size: Option<u64>) {
        self.encoder().clear_buffer(buffer, 0, size);
        self.transferred(size.unwrap_or(buffer.size()));
    }

    /// Fills a texture with zeros, in a pass without timing.
    pub(crate) fn clear_texture(&mut self, label: &str, view: &wgpu::TextureView) {
        let descriptor = wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &[cleared(view)],
            ..Default::default()
        };
        self.counts += Counts { passes: 1, bytes: attached(&descriptor), ..Counts::default() };
        self.transfers = false;
        self.encoder().begin_render_pass(&descriptor);
    }

    /// Copies the first `size` bytes of a buffer to the start of another one.
    pub(crate) fn copy_part(&mut self, from: &wgpu::Buffer, to: &wgpu::Buffer, size: u64) {
        self.encoder().copy_buffer_to_buffer(from, 0, to, 0, size);
        self.transferred(2 * size);
    }

    /// Copies a whole texture to another one of the same size.
    pub(crate) fn copy_texture(&mut self, from: &wgpu::Texture, to: &wgpu::Texture) {
        self.encoder().copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), to.size());
        self.transferred(2 * bytes(to));
    }

    /// Counts a copy or fill that moves `bytes` bytes.
    fn transferred(&mut self, bytes: u64) {
        let transfer_runs = u32::from(!self.transfers);
        self.counts += Counts { transfers: 1, transfer_runs, bytes, ..Counts::default() };
        self.transfers = true;
    }

    /// Begins a part of a stage. Commands recorded before belong to no row of the timings.
    pub(crate) fn start(&mut self) {
        self.counts = Counts::default();
        if let Some(timings) = &mut self.timings {
            timings.start();
        }
    }

    /// Ends a part of a stage and begins the next ([`Timings::lap`]).
    pub(crate) fn lap(&mut self, stage: Stage) {
        let name = stage.name();
        if let Some(probe) = &self.context.device.probe {
            probe.lap(name);
        }
        let counts = std::mem::take(&mut self.counts);
        if let Some(timings) = &mut self.timings {
            // The timings may finish the encoder.
            self.open = None;
            timings.lap(&self.context, self.encoder, (name, counts));
        }
    }

    /// Whether the frame is submitted in parts, which should be short.
    pub(crate) fn is_split(&self) -> bool {
        self.timings.as_ref().is_some_and(|timings| timings.is_split())
    }
}

/// A color attachment that is cleared to zero.
pub(crate) fn cleared(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    colored(view, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))
}

/// A color attachment.
pub(crate) fn colored(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}

/// A depth attachment, read-only without `depth_ops`.
pub(crate) fn deep(
    view: &wgpu::TextureView,
    depth_ops: Option<wgpu::Operations<f32>>,
) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
    Some(wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None })
}

/// Bytes that the attachments of a pass read when it begins and write when it ends.
fn attached(descriptor: &wgpu::RenderPassDescriptor<'_>) -> u64 {
    fn transfer_count<V>(ops: &wgpu::Operations<V>) -> u64 {
        u64::from(matches!(ops.load, wgpu::LoadOp::Load)) + u64::from(ops.store == wgpu::StoreOp::Store)
    }
    let color = descriptor.color_attachments.iter().flatten().map(|to| (to.view, transfer_count(&to.ops)));
    let depth = descriptor.depth_stencil_attachment.iter();
    // Read-only depth is read once.
    let depth = depth.map(|to| (to.view, to.depth_ops.as_ref().map_or(1, transfer_count)));
    color.chain(depth).map(|(view, times)| times * bytes(view.texture())).sum()
}

/// Bytes of the first mip level of one layer of a texture.
pub(crate) fn bytes(texture: &wgpu::Texture) -> u64 {
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    [texture.width(), texture.height(), texture.sample_count(), texel].map(u64::from).iter().product()
}

impl ComputePass<'_> {
    fn pass(&mut self) -> &mut wgpu::ComputePass<'static> {
        self.pass.as_mut().expect("the pass is not dropped")
    }

    fn probe(&mut self) {
        if let Some((group, from)) = self.groups.work() {
            self.pass().set_bind_group(GROUP, &group, &[from]);
        }
    }

    /// See [`wgpu::ComputePass::set_pipeline`].
    pub fn set_pipeline(&mut self, pipeline: &wgpu::ComputePipeline) {
        self.counts.pipelines += 1;
        self.pass().set_pipeline(pipeline);
    }

    /// See [`wgpu::ComputePass::set_bind_group`].
    pub fn set_bind_group(&mut self, index: u32, group: &wgpu::BindGroup, offsets: &[u32]) {
        self.counts.groups += 1;
        self.groups.set(index, group);
        self.pass().set_bind_group(index, group, offsets);
    }

    /// See [`wgpu::ComputePass::dispatch_workgroups`].
    pub fn dispatch_workgroups(&mut self, x: u32, y: u32, z: u32) {
        self.probe();
        self.counts.dispatches += 1;
        self.pass().dispatch_workgroups(x, y, z);
    }

    /// See [`wgpu::ComputePass::dispatch_workgroups_indirect`].
    pub(crate) fn dispatch_workgroups_indirect(&mut self, workgroups: &wgpu::Buffer, from: u64) {
        self.probe();
        *self.counts += Counts { dispatches: 1, indirect: 1, ..Counts::default() };
        self.pass().dispatch_workgroups_indirect(workgroups, from);
    }

    /// Notes the module path of the kernel that the next dispatches run.
    pub(super) fn name(&mut self, module: &'static str) {
        self.groups.name(module);
    }

    /// Stores the error of a kernel that could not be recorded.
    pub(super) fn fail(&mut self, error: Error) {
        self.error.get_or_insert(error);
    }

    /// Ends the pass.
    ///
    /// # Errors
    /// [`Error::Gpu`] for the first kernel recorded in the pass that failed to compile.
    pub fn end(self) -> Result<()> {
        self.error.take().map_or(Ok(()), Err)
    }
}

impl Drop for ComputePass<'_> {
    fn drop(&mut self) {
        if let Some(open) = &mut self.open {
            **open = self.pass.take();
        }
        if let Some(context) = self.flushes {
            context.flush_uniforms();
        }
    }
}

impl Drop for RenderPass<'_> {
    fn drop(&mut self) {
        if let Some(context) = self.flushes {
            context.flush_uniforms();
        }
    }
}

impl RenderPass<'_> {
    fn probe(&mut self) {
        if let Some((group, from)) = self.groups.work() {
            self.pass.set_bind_group(GROUP, &group, &[from]);
        }
    }

    /// See [`wgpu::RenderPass::set_pipeline`].
    pub fn set_pipeline(&mut self, pipeline: &wgpu::RenderPipeline) {
        self.counts.pipelines += 1;
        self.pass.set_pipeline(pipeline);
    }

    /// See [`wgpu::RenderPass::set_bind_group`].
    pub fn set_bind_group(&mut self, index: u32, group: &wgpu::BindGroup, offsets: &[u32]) {
        self.counts.groups += 1;
        self.groups.set(index, group);
        self.pass.set_bind_group(index, group, offsets);
    }

    /// See [`wgpu::RenderPass::set_vertex_buffer`].
    pub(crate) fn set_vertex_buffer(&mut self, slot: u32, vertices: wgpu::BufferSlice<'_>) {
        self.pass.set_vertex_buffer(slot, vertices);
    }

    /// See [`wgpu::RenderPass::set_index_buffer`].
    pub(crate) fn set_index_buffer(&mut self, indices: wgpu::BufferSlice<'_>, format: wgpu::IndexFormat) {
        self.pass.set_index_buffer(indices, format);
    }

    /// Sets the viewport, given by its upper left corner and its size, with depths from 0 to 1.
    pub fn set_viewport(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2]) {
        self.pass.set_viewport(x, y, width, height, 0.0, 1.0);
    }

    /// See [`wgpu::RenderPass::draw`].
    pub fn draw(&mut self, vertices: Range<u32>, instances: Range<u32>) {
        self.probe();
        self.counts.draws += 1;
        self.pass.draw(vertices, instances);
    }

    /// See [`wgpu::RenderPass::draw_indexed`].
    pub(crate) fn draw_indexed(&mut self, indices: Range<u32>, base: i32, instances: Range<u32>) {
        self.probe();
        self.counts.draws += 1;
        self.pass.draw_indexed(indices, base, instances);
    }
}
