//! Which strand vertices of a groom are shaded: those that a picture shows.

use super::{HairSet, Pipelines, Shaded, State, hair::shade_resources};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{Commands, Kernel},
    strands::buffers::storage,
};

/// The knots and spans that what is seen of a groom needs, found on the GPU each frame: no thread is spent on others.
#[derive(Debug)]
pub struct Chosen {
    /// Of the kernels over knots and over spans, each x, y, z and an unused word.
    workgroups: wgpu::Buffer,
    /// Knots, spans: how many, then which.
    lists: [wgpu::Buffer; 2],
    choose: wgpu::BindGroup,
    groups: [wgpu::BindGroup; 2],
    /// Whether the light has strand maps.
    strand_maps: bool,
}

impl Chosen {
    /// For `hair` as `shaded` in the light of `state`, seen by `camera`. `seen` has a bit for each strand vertex: whether
    /// the picture shows the segment that begins there.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(crate) fn new(
        context: &Context,
        (state, camera): (&State, &wgpu::Buffer),
        hair: &HairSet,
        shaded: &Shaded,
        seen: wgpu::BindingResource<'_>,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines = context.pipelines::<Pipelines>();
        // As many knots as there are room for.
        let most = 1 + shaded.most_knots;
        let lists =
            [storage::<u32>(device, "chosen knots", most)?, storage::<u32>(device, "chosen spans", most)?];
        let workgroups = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("chosen workgroups"),
            size: 32,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let own = [&shaded.uniform, &hair.strands.vertices, &hair.strands.strands, &shaded.colors]
            .map(wgpu::Buffer::as_entire_binding);
        let groups = lists.each_ref().map(|list| {
            let frame = state.frame_resources(camera);
            pipelines.shade(false).bind(&shade_resources(frame, &own, &shaded.knots, list))
        });
        let [uniform, knots, spans, counts] =
            [&shaded.uniform, &lists[0], &lists[1], &workgroups].map(wgpu::Buffer::as_entire_binding);
        let choose = pipelines.choose.bind(&[uniform, seen, knots, spans, counts]);
        let strand_maps = state.maps.strand_map > 0;
        Ok(Self { workgroups, lists, choose, groups, strand_maps })
    }

    /// Empties the lists; before [`record`](Self::record), outside of passes.
    pub(super) fn clear(&self, commands: &mut Commands<'_>) {
        commands.clear(&self.workgroups, None);
        self.lists.iter().for_each(|list| commands.clear(list, Some(4)));
    }

    /// Chooses and shades.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        pass: &mut crate::gpu::ComputePass<'_>,
        hair: &HairSet,
    ) {
        pipelines.choose.record(pass, &self.choose, &[], hair.drawn.count.div_ceil(STRAND_WORKGROUP));
        pass.set_bind_group(1, &pipelines.gap, &[]);
        pass.set_bind_group(2, &hair.fiber().group, &[]);
        let kernels: [&Kernel; 2] = [&pipelines.knots, pipelines.shade(self.strand_maps)];
        for (i, (kernel, group)) in kernels.into_iter().zip(&self.groups).enumerate() {
            kernel.record_indirect(pass, group, &[], (&self.workgroups, 16 * i as u64));
        }
    }
}
