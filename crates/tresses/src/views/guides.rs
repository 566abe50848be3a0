//! Host side of `guides.wesl`.

use super::{Canvas, LinePoint, constant, scratch::Scratch};
use crate::{
    Context, Pose, Result,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, Kernel},
    shaders::kernels::views as kernels,
    strands::GuideBuffers,
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// Quantity that colors a guide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GuideQuantity {
    /// Speed after the last step, m/s.
    Speed = 0,
    /// Difference of an edge's length from its rest length, as a fraction of the rest length.
    Strain = 1,
    /// Index of the guide, a color for each.
    Guide = 2,
}

/// The kernel's uniform.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GuidesUniform {
    /// Number of guides.
    pub count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Samples per guide.
    pub sample_count: u32,
    /// [`GuideQuantity`].
    pub quantity: u32,
    /// Rotation from simulation space to the space in which hair is drawn.
    pub rotation: Quat,
    /// Translation between those spaces, meters.
    pub translation: Vec3,
    /// Unused.
    pub _pad: u32,
}

/// Kernel that turns guides into lines.
#[derive(Debug)]
pub(super) struct GuidesKernel(Kernel, Scratch);

impl GuidesKernel {
    pub(super) fn new(context: &Context) -> Self {
        Self(Kernel::new::<kernels::Guides>(&context.device), Scratch::default())
    }

    /// Records the kernel and returns its output: a point per guide sample. Guides without samples have a point per
    /// vertex after the last step, transformed by `pose` from simulation space to the world.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        guides: &GuideBuffers,
        pose: &Pose,
        quantity: GuideQuantity,
    ) -> Result<wgpu::Buffer> {
        let total = u64::from(guides.count) * u64::from(guides.line_count());
        let points = self.1.get::<LinePoint>(canvas.device, "guide lines", total)?;
        let uniform = constant(
            canvas.device,
            "guide lines",
            &GuidesUniform {
                count: guides.count,
                vertex_count: guides.vertex_count,
                sample_count: guides.line_count(),
                quantity: quantity as u32,
                rotation: pose.rotation,
                translation: pose.translation,
                _pad: 0,
            },
        );
        let group = self.0.bind(&kernels::Guides {
            params: uniform.entire(),
            samples: guides.samples.entire(),
            rest: guides.rest.entire(),
            current: guides.current.entire(),
            velocity: guides.velocity.entire(),
            points: points.entire(),
            info: guides.info.entire(),
        });
        let workgroups = (total as u32).div_ceil(STRAND_WORKGROUP);
        let mut pass = canvas.commands.compute("debug");
        self.0.record(&mut pass, &group, &[], workgroups);
        pass.end()?;
        Ok(points)
    }
}
