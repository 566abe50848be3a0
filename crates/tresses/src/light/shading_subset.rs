//! Shading of the visible strand vertices of a groom only.

use super::{HairSet, HairShading, LightState, Pipelines};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, BufferBinding, Commands, Kernel},
    shaders::kernels::light as kernels,
    strands::buffers::storage,
};

/// The knots and spans that the visible segments of a groom need. The GPU selects them each frame, and spends no
/// threads on the others.
#[derive(Debug)]
pub struct ShadingSubset {
    /// Indirect dispatch sizes of the kernels over knots and over spans: x, y, z and an unused word each.
    workgroups: wgpu::Buffer,
    /// Knots and spans, each as a count followed by indices.
    lists: [wgpu::Buffer; 2],
    select_visible: wgpu::BindGroup,
    groups: [wgpu::BindGroup; 2],
    /// Whether the light has strand maps.
    strand_maps: bool,
}

impl ShadingSubset {
    /// Creates the lists for `hair`, shaded as `shaded` in the light of `state` and seen by `camera`. `visible` has one
    /// bit per strand vertex: whether the segment that begins there is visible.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold the lists.
    pub(crate) fn new(
        context: &Context,
        (state, camera): (&LightState, &wgpu::Buffer),
        hair: &HairSet,
        shaded: &HairShading,
        visible: BufferBinding<'_, u32>,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines = context.pipelines::<Pipelines>();
        // Room for all knots.
        let capacity = 1 + shaded.sample_capacity;
        let lists = [
            storage::<u32>(device, "chosen knots", capacity)?,
            storage::<u32>(device, "chosen spans", capacity)?,
        ];
        let workgroups = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("chosen workgroups"),
            size: 32,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let groups = lists.each_ref().map(|list| {
            let sample_bindings = shaded.sample_bindings(camera, hair, list);
            pipelines.shade(false).bind(&state.shading(sample_bindings))
        });
        let select_visible = pipelines.select_visible.bind(&kernels::SelectVisible {
            hair: shaded.uniform.entire(),
            visible,
            samples: lists[0].entire(),
            spans: lists[1].entire(),
            workgroups: workgroups.entire(),
        });
        let strand_maps = state.maps.strand_map > 0;
        Ok(Self { workgroups, lists, select_visible, groups, strand_maps })
    }

    /// Clears the lists. Call it before [`record`](Self::record), outside of passes.
    pub(super) fn clear(&self, commands: &mut Commands<'_>) {
        commands.clear(&self.workgroups, None);
        self.lists.iter().for_each(|list| commands.clear(list, Some(4)));
    }

    /// Records the selection, then the shading of the selected knots and spans.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        pass: &mut crate::gpu::ComputePass<'_>,
        hair: &HairSet,
    ) {
        pipelines.select_visible.record(
            pass,
            &self.select_visible,
            &[],
            hair.drawn.count.div_ceil(STRAND_WORKGROUP),
        );
        pass.set_bind_group(1, &pipelines.gap, &[]);
        pass.set_bind_group(2, &hair.fiber().group, &[]);
        let kernels: [&Kernel; 2] = [&pipelines.shading_samples, pipelines.shade(self.strand_maps)];
        for (i, (kernel, group)) in kernels.into_iter().zip(&self.groups).enumerate() {
            kernel.record_indirect(pass, group, &[], (&self.workgroups, 16 * i as u64));
        }
    }
}
