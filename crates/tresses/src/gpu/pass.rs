//! Passes that count what is recorded into them: each pass, dispatch, draw, change of pipeline and bound group costs
//! on every driver, whatever it does.
//!
//! Counting is a few additions per pass. Who wants to know reads [`Timings::counts`](super::Timings::counts), which
//! ascribes them to the rows of the frame.

use super::probe::{GROUP, Groups};
use std::{
    cell::Cell,
    ops::{AddAssign, Range},
};

/// How much was recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Compute and render passes.
    pub passes: u32,
    /// Dispatches, those included whose workgroups the GPU counts.
    pub dispatches: u32,
    /// Draws.
    pub draws: u32,
    /// Pipelines that were set.
    pub pipelines: u32,
    /// Bind groups that were set.
    pub groups: u32,
    /// Copies and fills outside of passes.
    pub transfers: u32,
    /// Bytes that attachments and transfers read and write by what they are, whatever shaders do.
    pub bytes: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passes += other.passes;
        self.dispatches += other.dispatches;
        self.draws += other.draws;
        self.pipelines += other.pipelines;
        self.groups += other.groups;
        self.transfers += other.transfers;
        self.bytes += other.bytes;
    }
}

thread_local! {
    /// Of what this thread has recorded since somebody took it.
    static COUNTS: Cell<Counts> = const { Cell::new(Counts {
        passes: 0,
        dispatches: 0,
        draws: 0,
        pipelines: 0,
        groups: 0,
        transfers: 0,
        bytes: 0,
    }) };
}

fn count(counts: Counts) {
    let mut all = COUNTS.get();
    all += counts;
    COUNTS.set(all);
}

/// What this thread has recorded since the last call.
pub(crate) fn take() -> Counts {
    COUNTS.take()
}

/// A compute pass that counts.
#[derive(Debug)]
pub struct ComputePass<'a> {
    pass: wgpu::ComputePass<'a>,
    counts: Counts,
    groups: Groups,
}

/// A render pass that counts.
#[derive(Debug)]
pub struct RenderPass<'a> {
    pass: wgpu::RenderPass<'a>,
    counts: Counts,
    groups: Groups,
}

/// Begins a compute pass.
pub fn compute_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    descriptor: &wgpu::ComputePassDescriptor<'_>,
) -> ComputePass<'a> {
    let counts = Counts { passes: 1, ..Counts::default() };
    ComputePass { pass: encoder.begin_compute_pass(descriptor), counts, groups: Groups::default() }
}

/// Begins a render pass.
pub fn render_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    descriptor: &wgpu::RenderPassDescriptor<'_>,
) -> RenderPass<'a> {
    let counts = Counts { passes: 1, bytes: attached(descriptor), ..Counts::default() };
    RenderPass { pass: encoder.begin_render_pass(descriptor), counts, groups: Groups::default() }
}

/// Fills `size` bytes of a buffer with zeros, or all of it.
pub fn clear(encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer, size: Option<u64>) {
    encoder.clear_buffer(buffer, 0, size);
    count(Counts { transfers: 1, bytes: size.unwrap_or(buffer.size()), ..Counts::default() });
}

/// Takes note of a copy of so many bytes, which are read and written.
pub(crate) fn copied(bytes: u64) {
    count(Counts { transfers: 1, bytes: 2 * bytes, ..Counts::default() });
}

/// Bytes that the attachments of a pass are read with when it begins and written with when it ends or clears.
fn attached(descriptor: &wgpu::RenderPassDescriptor<'_>) -> u64 {
    fn moved<V>(ops: &wgpu::Operations<V>) -> u64 {
        u64::from(matches!(ops.load, wgpu::LoadOp::Load)) + u64::from(ops.store == wgpu::StoreOp::Store)
    }
    let color = descriptor.color_attachments.iter().flatten().map(|to| (to.view, moved(&to.ops)));
    let depth = descriptor.depth_stencil_attachment.iter();
    // Depth that is read only is read.
    let depth = depth.map(|to| (to.view, to.depth_ops.as_ref().map_or(1, moved)));
    color.chain(depth).map(|(view, times)| times * bytes(view.texture())).sum()
}

/// Bytes of one layer of a texture at its finest.
pub(crate) fn bytes(texture: &wgpu::Texture) -> u64 {
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    [texture.width(), texture.height(), texture.sample_count(), texel].map(u64::from).iter().product()
}

impl ComputePass<'_> {
    fn probe(&mut self) {
        if let Some((group, from)) = self.groups.work() {
            self.pass.set_bind_group(GROUP, &group, &[from]);
        }
    }

    /// As of wgpu's pass.
    pub fn set_pipeline(&mut self, pipeline: &wgpu::ComputePipeline) {
        self.counts.pipelines += 1;
        self.pass.set_pipeline(pipeline);
    }

    /// As of wgpu's pass.
    pub fn set_bind_group(&mut self, index: u32, group: &wgpu::BindGroup, offsets: &[u32]) {
        self.counts.groups += 1;
        self.groups.set(index, group);
        self.pass.set_bind_group(index, group, offsets);
    }

    /// As of wgpu's pass.
    pub fn dispatch_workgroups(&mut self, x: u32, y: u32, z: u32) {
        self.probe();
        self.counts.dispatches += 1;
        self.pass.dispatch_workgroups(x, y, z);
    }

    /// As of wgpu's pass.
    pub fn dispatch_workgroups_indirect(&mut self, workgroups: &wgpu::Buffer, from: u64) {
        self.probe();
        self.counts.dispatches += 1;
        self.pass.dispatch_workgroups_indirect(workgroups, from);
    }
}

impl RenderPass<'_> {
    fn probe(&mut self) {
        if let Some((group, from)) = self.groups.work() {
            self.pass.set_bind_group(GROUP, &group, &[from]);
        }
    }

    /// As of wgpu's pass.
    pub fn set_pipeline(&mut self, pipeline: &wgpu::RenderPipeline) {
        self.counts.pipelines += 1;
        self.pass.set_pipeline(pipeline);
    }

    /// As of wgpu's pass.
    pub fn set_bind_group(&mut self, index: u32, group: &wgpu::BindGroup, offsets: &[u32]) {
        self.counts.groups += 1;
        self.groups.set(index, group);
        self.pass.set_bind_group(index, group, offsets);
    }

    /// As of wgpu's pass.
    pub fn set_vertex_buffer(&mut self, slot: u32, vertices: wgpu::BufferSlice<'_>) {
        self.pass.set_vertex_buffer(slot, vertices);
    }

    /// As of wgpu's pass.
    pub fn set_index_buffer(&mut self, indices: wgpu::BufferSlice<'_>, format: wgpu::IndexFormat) {
        self.pass.set_index_buffer(indices, format);
    }

    /// A viewport of depths from 0 to 1, from its upper left corner on.
    pub fn set_viewport(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2]) {
        self.pass.set_viewport(x, y, width, height, 0.0, 1.0);
    }

    /// As of wgpu's pass.
    pub fn draw(&mut self, vertices: Range<u32>, instances: Range<u32>) {
        self.probe();
        self.counts.draws += 1;
        self.pass.draw(vertices, instances);
    }

    /// As of wgpu's pass.
    pub fn draw_indexed(&mut self, indices: Range<u32>, base: i32, instances: Range<u32>) {
        self.probe();
        self.counts.draws += 1;
        self.pass.draw_indexed(indices, base, instances);
    }
}

impl Drop for ComputePass<'_> {
    fn drop(&mut self) {
        count(self.counts);
    }
}

impl Drop for RenderPass<'_> {
    fn drop(&mut self) {
        count(self.counts);
    }
}
