//! Host side of `streams.wesl`.

use super::{Canvas, GridView, LinePoint, constant, scratch::Scratch};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, Kernel},
    shaders::kernels::views as kernels,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use wgpu::util::DeviceExt;

/// Streamlines: start points and length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Streams<'a> {
    /// Start points in world space, meters.
    pub seeds: &'a [Vec3],
    /// Points of each line, at least 2.
    pub points: u32,
    /// Distance from point to point, meters.
    pub step: f32,
    /// Minimum speed. A line ends where the field is slower.
    pub min_speed: f32,
}

impl Streams<'_> {
    /// Returns seeds for a wind along `wind` through the box of `grid`: a square lattice of `count` × `count` points,
    /// as wide as the shortest edge of the box, on the side where the wind enters.
    pub fn upwind(grid: &GridView<'_>, wind: Vec3, count: u32) -> Vec<Vec3> {
        let along = grid.pose.rotation.conjugate() * wind.normalize_or(Vec3::Z);
        // From the middle against the wind to the face of the box, and a little back into the box.
        let half = 0.5 * grid.extent();
        let distance = 0.98 * (half / along.abs().max(Vec3::splat(1e-6))).min_element();
        let (right, up) = along.any_orthonormal_pair();
        let center = (Vec3::splat(0.5) - grid.bias) / grid.scale - along * distance;
        let width = 0.96 * 2.0 * half.min_element();
        let offset = |i: u32| ((i as f32 + 0.5) / count as f32 - 0.5) * width;
        (0..count * count)
            .map(|i| grid.pose.point(center + right * offset(i % count) + up * offset(i / count)))
            .collect()
    }
}

/// Shader data of [`Streams`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct StreamsUniform {
    /// Number of lines.
    pub seeds: u32,
    /// [`Streams::points`].
    pub points: u32,
    /// [`Streams::step`].
    pub step: f32,
    /// [`Streams::min_speed`].
    pub min_speed: f32,
}

/// Kernel that traces streamlines.
#[derive(Debug)]
pub(super) struct StreamsKernel(Kernel, Scratch);

impl StreamsKernel {
    pub(super) fn new(context: &Context) -> Self {
        Self(Kernel::new::<kernels::Streams>(&context.device), Scratch::default())
    }

    /// Records the kernel and returns its output, `streams.points` points per seed, or `None` without seeds.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        grid: &GridView<'_>,
        streams: &Streams<'_>,
    ) -> Result<Option<wgpu::Buffer>> {
        if streams.seeds.is_empty() {
            return Ok(None);
        }
        let uniform = StreamsUniform {
            seeds: streams.seeds.len() as u32,
            points: streams.points.max(2),
            step: streams.step,
            min_speed: streams.min_speed,
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
        let (grid_uniform, uniform) = (canvas.grid(grid), constant(canvas.device, "streams", &uniform));
        let group = self.0.bind(&kernels::Streams {
            grid: grid_uniform.entire(),
            params: uniform.entire(),
            values: grid.texture,
            linear_clamp: canvas.sampler,
            seeds: seeds.entire(),
            points: points.entire(),
        });
        let mut pass = canvas.commands.compute("debug");
        self.0.record(&mut pass, &group, &[], workgroups);
        pass.end()?;
        Ok(Some(points))
    }
}
