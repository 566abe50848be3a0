//! Host side of `strands.wesl`: colors strands by a quantity. The normal pipelines of hair draw them.

use super::constant;
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, Commands, Kernel},
    hair::Hair,
    light::HairView,
    shaders::kernels::views as kernels,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Quantity that colors a drawn strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StrandQuantity {
    /// Guide with the largest weight.
    Lock = 0,
    /// Strand, a color for each.
    Strand = 1,
    /// Direction in world axes, as in a normal map.
    Tangent = 2,
    /// Distance from the root at which an obstacle changes the strand, meters.
    FirstHit = 3,
    /// Factor on the width relative to full detail, in doublings. Segments are visible.
    Detail = 4,
}

/// The kernel's uniform.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct StrandsUniform {
    /// Position of the camera, meters.
    pub eye: Vec3,
    /// [`StrandQuantity`].
    pub quantity: u32,
    /// Value drawn brightest.
    pub high: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// Kernel that colors strands.
#[derive(Debug)]
pub(super) struct StrandsKernel(Kernel);

impl StrandsKernel {
    pub(super) fn new(context: &Context) -> Self {
        Self(Kernel::new::<kernels::Strands>(&context.device))
    }

    /// Records the kernel, which writes a color instead of radiance for every drawn vertex: `quantity` seen from `eye`,
    /// with `high` drawn brightest.
    pub(super) fn record(
        &self,
        commands: &mut Commands<'_>,
        hair: &Hair,
        view: &HairView<'_>,
        (eye, quantity, high): (Vec3, StrandQuantity, f32),
    ) -> Result<()> {
        let uniform = StrandsUniform { eye, quantity: quantity as u32, high: high.max(1e-9), _pad: [0; 3] };
        let uniform = constant(&hair.asset.context.device, "debug strands", &uniform);
        let (set, strands) = (view.hair, &hair.strands);
        let group = self.0.bind(&kernels::Strands {
            params: uniform.entire(),
            hair: view.shaded.uniform.entire(),
            vertices: strands.vertices.entire(),
            info: strands.strands.entire(),
            bindings: strands.bindings.entire(),
            states: hair.avoidance.states().entire(),
            widening: strands.widening.entire(),
            shaded: view.shaded.colors.entire(),
        });
        let workgroups = (set.drawn.count * set.drawn.vertex_count).div_ceil(STRAND_WORKGROUP);
        let mut pass = commands.compute("shade");
        self.0.record(&mut pass, &group, &[], workgroups);
        pass.end()
    }
}
