//! Shading of the visible strand vertices of a groom only.

use super::{HairSet, HairShading, LightState, Pipelines};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, BufferBinding, Commands, Kernel, Uniform},
    shaders::kernels::light as kernels,
    strands::buffers::storage_with,
};

/// Bytes of the buffer before its lists: workgroups and number of items of each.
const HEAD_BYTES: u64 = 32;

/// The samples and spans that the visible segments of a groom need. The GPU selects them each frame, and spends no
/// threads on the others.
#[derive(Debug)]
pub struct ShadingSubset {
    /// See `select_visible.wesl`.
    selected: wgpu::Buffer,
    select_visible: wgpu::BindGroup,
    group: wgpu::BindGroup,
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
        (state, camera): (&LightState, &Uniform),
        hair: &HairSet,
        shaded: &HairShading,
        visible: BufferBinding<'_, u32>,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines = context.pipelines::<Pipelines>();
        // There are more samples than spans.
        let words = HEAD_BYTES / 4 + 2 * shaded.sample_capacity;
        let usage = wgpu::BufferUsages::INDIRECT;
        let selected = storage_with::<u32>(device, "selected samples and spans", words, usage)?;
        let group = pipelines
            .shade(false, false)
            .bind(&state.shading(shaded.sample_bindings(camera, hair, &selected)));
        let select_visible = pipelines.select_visible.bind(&kernels::SelectVisible {
            hair: shaded.uniform.entire(),
            visible,
            selected: selected.entire(),
        });
        let strand_maps = state.maps.strand_map > 0;
        Ok(Self { selected, select_visible, group, strand_maps })
    }

    /// Clears the lists. Call it before [`record`](Self::record), outside of passes.
    pub(super) fn clear(&self, commands: &mut Commands<'_>) {
        commands.clear(&self.selected, Some(HEAD_BYTES));
    }

    /// Records the selection, then the shading of the selected samples and spans.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        pass: &mut crate::gpu::ComputePass<'_>,
        hair: &HairSet,
        near_lights: bool,
    ) {
        pipelines.select_visible.record(
            pass,
            &self.select_visible,
            &[],
            hair.drawn.count.div_ceil(STRAND_WORKGROUP),
        );
        pass.set_bind_group(1, &pipelines.gap, &[]);
        pass.set_bind_group(2, &hair.fiber().group, &[]);
        let kernels: [&Kernel; 2] =
            [pipelines.shading_samples(near_lights), pipelines.shade(self.strand_maps, near_lights)];
        for (i, kernel) in kernels.into_iter().enumerate() {
            kernel.record_indirect(pass, &self.group, &[], (&self.selected, 16 * i as u64));
        }
    }
}
