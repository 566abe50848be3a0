//! Host side of `arrows.wesl`.

use super::{Canvas, GridView, LinePoint, constant, scratch::Scratch};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, Kernel},
    shaders::kernels::views as kernels,
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3};

/// A lattice of arrows in a grid, centered on the points of the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arrows {
    /// Texture coordinate of the first lattice point.
    pub first: Vec3,
    /// Texture coordinates from one point to the next.
    pub step: Vec3,
    /// Points along each axis.
    pub count: UVec3,
    /// Travel time that gives the length of an arrow, seconds (s² if the vectors are accelerations).
    pub seconds: f32,
    /// Maximum length of an arrow, meters.
    pub longest: f32,
    /// Minimum length of a vector that is drawn.
    pub min_value: f32,
}

impl Arrows {
    /// Returns a lattice over the plane across `axis` (0 to 2) at texture coordinate `at` or, without an axis, over the
    /// whole box. It has `count` points along each edge. Where the value is `high`, an arrow is about as long as the
    /// distance between two points.
    pub fn over(grid: &GridView<'_>, axis: Option<(usize, f32)>, count: u32, high: f32) -> Self {
        let count = count.max(1);
        let step = Vec3::splat(1.0 / count as f32);
        let (mut first, mut counts) = (0.5 * step, UVec3::splat(count));
        if let Some((axis, at)) = axis {
            first[axis.min(2)] = at;
            counts[axis.min(2)] = 1;
        }
        let longest = 0.95 * (grid.extent() * step).min_element();
        Self {
            first,
            step,
            count: counts,
            seconds: longest / high.max(1e-20),
            longest,
            min_value: 0.02 * high,
        }
    }
}

/// Shader data of [`Arrows`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ArrowsUniform {
    /// [`Arrows::first`].
    pub first: Vec3,
    /// [`Arrows::seconds`].
    pub seconds: f32,
    /// [`Arrows::step`].
    pub step: Vec3,
    /// [`Arrows::longest`].
    pub longest: f32,
    /// [`Arrows::count`].
    pub count: UVec3,
    /// [`Arrows::min_value`].
    pub min_value: f32,
}

/// Kernel that turns vectors into arrows.
#[derive(Debug)]
pub(super) struct ArrowsKernel(Kernel, Scratch);

impl ArrowsKernel {
    pub(super) fn new(context: &Context) -> Self {
        Self(Kernel::new::<kernels::Arrows>(&context.device), Scratch::default())
    }

    /// Records the kernel and returns its output, four points per arrow.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        grid: &GridView<'_>,
        arrows: &Arrows,
    ) -> Result<wgpu::Buffer> {
        let count = arrows.count.max(UVec3::ONE);
        let total = count.x.saturating_mul(count.y).saturating_mul(count.z);
        let points = self.1.get::<LinePoint>(canvas.device, "arrows", 4 * u64::from(total))?;
        let uniform = ArrowsUniform {
            first: arrows.first,
            seconds: arrows.seconds,
            step: arrows.step,
            longest: arrows.longest,
            count,
            min_value: arrows.min_value,
        };
        let (grid_uniform, uniform) = (canvas.grid(grid), constant(canvas.device, "arrows", &uniform));
        let group = self.0.bind(&kernels::Arrows {
            grid: grid_uniform.entire(),
            params: uniform.entire(),
            values: grid.texture,
            linear_clamp: canvas.sampler,
            points: points.entire(),
        });
        let mut pass = canvas.commands.compute("debug");
        self.0.record(&mut pass, &group, &[], total.div_ceil(STRAND_WORKGROUP));
        pass.end()?;
        Ok(points)
    }
}
