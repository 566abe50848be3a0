//! Host side of `arrows.wesl`.

use super::{Canvas, Grid, LinePoint, constant, scratch::Scratch};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Kernel},
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3};

/// A lattice of arrows in a grid; their middles are on its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrows {
    /// Texture coordinate of the lattice's first point.
    pub first: Vec3,
    /// Texture coordinates from one point to the next.
    pub step: Vec3,
    /// Points along each axis.
    pub count: UVec3,
    /// An arrow is as long as the distance travelled in this time, seconds (of accelerations: s²).
    pub seconds: f32,
    /// But no longer than this, metres.
    pub longest: f32,
    /// Vectors shorter than this are left out.
    pub least: f32,
}

impl Arrows {
    /// A lattice over the plane across `axis` (0 to 2) at texture coordinate `at`, or, without an
    /// axis, over the whole box: `count` points along each edge, arrows that are as long as their
    /// distance where the value is `high`.
    pub fn over(grid: &Grid<'_>, axis: Option<(usize, f32)>, count: u32, high: f32) -> Self {
        let count = count.max(1);
        let step = Vec3::splat(1.0 / count as f32);
        let (mut first, mut counts) = (0.5 * step, UVec3::splat(count));
        if let Some((axis, at)) = axis {
            first[axis.min(2)] = at;
            counts[axis.min(2)] = 1;
        }
        let longest = 0.95 * (grid.extent() * step).min_element();
        Self { first, step, count: counts, seconds: longest / high.max(1e-20), longest, least: 0.02 * high }
    }
}

/// What the kernel knows of [`Arrows`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ArrowsUniform {
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
    /// [`Arrows::least`].
    pub least: f32,
}

/// The pipeline.
#[derive(Debug)]
pub(super) struct ArrowsKernel(Kernel, Scratch);

impl ArrowsKernel {
    pub(super) fn new(context: &Context) -> Self {
        use Binding::{Sampler, StorageMut, Texture3d, Uniform};
        let entries = [Uniform, Uniform, Texture3d, Sampler, StorageMut];
        Self(Kernel::new(&context.device, "views::arrows", &entries), Scratch::default())
    }

    /// Four points per arrow.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        grid: &Grid<'_>,
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
            least: arrows.least,
        };
        let (place, uniform) = (canvas.grid(grid), constant(canvas.device, "arrows", &uniform));
        let resources = [
            place.as_entire_binding(),
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(grid.texture),
            wgpu::BindingResource::Sampler(canvas.sampler),
            points.as_entire_binding(),
        ];
        let group = self.0.bind(&resources);
        let mut pass = canvas.commands.compute("debug");
        self.0.record(&mut pass, &group, &[], total.div_ceil(STRAND_WORKGROUP));
        pass.end()?;
        Ok(points)
    }
}
