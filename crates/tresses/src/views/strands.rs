//! Host side of `strands.wesl`: strands in colours that stand for something, through the pipelines
//! that draw hair.

use super::constant;
use crate::{
    Context, Hair, Result,
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Commands, Kernel},
    light::Seen,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// What the colour of a drawn strand stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrandQuantity {
    /// The guide with the largest weight.
    Lock = 0,
    /// The strand itself.
    Strand = 1,
    /// The direction, world axes, as in a normal map.
    Tangent = 2,
    /// Where the strand has changed over because of an obstacle, metres from its root.
    FirstHit = 3,
    /// By how much it is wider than it would be at full detail, in doublings; its segments show.
    Detail = 4,
}

/// The kernel's uniform.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct StrandsUniform {
    /// Where the camera is, metres.
    pub eye: Vec3,
    /// [`StrandQuantity`].
    pub quantity: u32,
    /// The number that is drawn brightest.
    pub high: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// The pipeline.
#[derive(Debug)]
pub(super) struct StrandsKernel(Kernel);

impl StrandsKernel {
    pub(super) fn new(context: &Context) -> Self {
        use Binding::{Storage, StorageMut, Uniform};
        let entries = [Storage, Uniform, Storage, Storage, Storage, Storage, Storage, StorageMut];
        Self(Kernel::new(&context.device, "views::strands", &entries))
    }

    /// Colours instead of radiance, for every vertex that is drawn: a quantity as `eye` sees it, `high` the brightest.
    pub(super) fn record(
        &self,
        commands: &mut Commands<'_>,
        hair: &Hair,
        seen: &Seen<'_>,
        (eye, quantity, high): (Vec3, StrandQuantity, f32),
    ) -> Result<()> {
        let uniform = StrandsUniform { eye, quantity: quantity as u32, high: high.max(1e-9), _pad: [0; 3] };
        let uniform = constant(&hair.context.device, "debug strands", &uniform);
        let (set, strands) = (seen.hair, &hair.strands);
        let buffers = [
            &uniform,
            &seen.shaded.uniform,
            &strands.vertices,
            &strands.strands,
            &strands.bindings,
            hair.avoidance.states(),
            &strands.widening,
            &seen.shaded.colors,
        ];
        let group = self.0.bind(&buffers.map(|buffer| buffer.as_entire_binding()));
        let workgroups = (set.drawn.count * set.drawn.vertex_count).div_ceil(STRAND_WORKGROUP);
        let mut pass = commands.compute("shade");
        self.0.record(&mut pass, &group, &[], workgroups);
        pass.end()
    }
}
