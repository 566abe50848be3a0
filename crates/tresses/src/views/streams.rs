//! Host side of `streams.wesl`.

use super::{Canvas, Grid, LinePoint, constant, scratch::Scratch};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Kernel},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use wgpu::util::DeviceExt;

/// Streamlines: where they begin and how far they go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Streams<'a> {
    /// World space, metres.
    pub seeds: &'a [Vec3],
    /// Points of each line, at least 2.
    pub points: u32,
    /// From point to point, metres.
    pub step: f32,
    /// A line ends where the field is slower than this.
    pub least: f32,
}

impl Streams<'_> {
    /// Seeds for a wind along `wind` through the box of `grid`: a square lattice of `count` ×
    /// `count` points before the box's middle, as wide as the box's shortest edge, where the wind
    /// comes in.
    pub fn upwind(grid: &Grid<'_>, wind: Vec3, count: u32) -> Vec<Vec3> {
        let along = grid.pose.rotation.conjugate() * wind.normalize_or(Vec3::Z);
        // From the middle against the wind to the box's face, and a little back into the box.
        let half = 0.5 * grid.extent();
        let reach = 0.98 * (half / along.abs().max(Vec3::splat(1e-6))).min_element();
        let (right, up) = along.any_orthonormal_pair();
        let middle = (Vec3::splat(0.5) - grid.bias) / grid.scale - along * reach;
        let width = 0.96 * 2.0 * half.min_element();
        let place = |i: u32| ((i as f32 + 0.5) / count as f32 - 0.5) * width;
        (0..count * count)
            .map(|i| grid.pose.point(middle + right * place(i % count) + up * place(i / count)))
            .collect()
    }
}

/// What the kernel knows of [`Streams`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct StreamsUniform {
    /// How many lines.
    pub seeds: u32,
    /// [`Streams::points`].
    pub points: u32,
    /// [`Streams::step`].
    pub step: f32,
    /// [`Streams::least`].
    pub least: f32,
}

/// The pipeline.
#[derive(Debug)]
pub(super) struct StreamsKernel(Kernel, Scratch);

impl StreamsKernel {
    pub(super) fn new(context: &Context) -> Self {
        use Binding::{Sampler, Storage, StorageMut, Texture3d, Uniform};
        let entries = [Uniform, Uniform, Texture3d, Sampler, Storage, StorageMut];
        Self(Kernel::new(&context.device, "views::streams", &entries), Scratch::default())
    }

    /// `streams.points` points per seed; nothing without seeds.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        grid: &Grid<'_>,
        streams: &Streams<'_>,
    ) -> Result<Option<wgpu::Buffer>> {
        if streams.seeds.is_empty() {
            return Ok(None);
        }
        let uniform = StreamsUniform {
            seeds: streams.seeds.len() as u32,
            points: streams.points.max(2),
            step: streams.step,
            least: streams.least,
        };
        let total = u64::from(uniform.seeds) * u64::from(uniform.points);
        let points = self.1.get::<LinePoint>(canvas.device, "streams", total)?;
        let seeds: Vec<_> = streams.seeds.iter().map(|seed| seed.extend(0.0).to_array()).collect();
        let seeds = canvas.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("seeds"),
            contents: bytemuck::cast_slice(&seeds),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let workgroups = uniform.seeds.div_ceil(STRAND_WORKGROUP);
        let (place, uniform) = (canvas.grid(grid), constant(canvas.device, "streams", &uniform));
        let resources = [
            place.as_entire_binding(),
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(grid.texture),
            wgpu::BindingResource::Sampler(canvas.sampler),
            seeds.as_entire_binding(),
            points.as_entire_binding(),
        ];
        let group = self.0.bind(&resources);
        let mut pass = canvas.commands.compute("debug");
        self.0.record(&mut pass, &group, &[], workgroups);
        pass.end()?;
        Ok(Some(points))
    }
}
