//! Host side of `lines.wesl`: lines with a width in pixels, the output of arrows, streamlines, guides and outlines.

use super::{Canvas, Paint, constant, overlay};
use crate::{
    Result,
    gpu::{Binding, Device, bindings::layout},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use wgpu::util::DeviceExt;

/// Width of the dark rim on both sides of a line, pixels.
const RIM: f32 = 1.0;

/// A point of a line.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct LinePoint {
    /// World position, meters.
    pub position: Vec3,
    /// Value that sets the color.
    pub value: f32,
    /// Width, pixels.
    pub width: f32,
    /// Opacity. If it is negative, the line is interrupted here.
    pub alpha: f32,
    /// 0 for the color of `value`; otherwise the number, from 1, of an item with its own color.
    pub tint: u32,
    /// Unused.
    pub _pad: u32,
}

/// The shader's uniform.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LinesUniform {
    /// Points of each line, at least 2.
    pub points: u32,
    /// Width of the dark rim, pixels.
    pub rim: f32,
    /// Unused.
    pub _pad: [u32; 2],
}

/// Pipeline that draws lines.
#[derive(Debug)]
pub(super) struct Lines {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl Lines {
    pub(super) fn new(
        device: &Device,
        view: &wgpu::BindGroupLayout,
        format: wgpu::TextureFormat,
    ) -> Result<Self> {
        let entries = [Binding::Storage, Binding::Storage, Binding::Storage];
        let layout = layout(device, "lines", wgpu::ShaderStages::VERTEX_FRAGMENT, &entries);
        let topology = wgpu::PrimitiveTopology::TriangleList;
        let pipeline = overlay(device, "views::lines", &[&layout, view], format, topology, true)?;
        Ok(Self { pipeline, layout })
    }

    /// Records lines of `per_line` points each.
    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        points: &wgpu::Buffer,
        per_line: u32,
        paint: &Paint,
    ) {
        let uniform =
            constant(canvas.device, "lines", &LinesUniform { points: per_line, rim: RIM, _pad: [0; 2] });
        let paint = canvas.paint(paint);
        let resources = [&paint, &uniform, points].map(|buffer| buffer.as_entire_binding());
        let group = canvas.device.group("lines", &self.layout, &resources);
        let lines = (points.size() / size_of::<LinePoint>() as u64) as u32 / per_line;
        let view = canvas.view;
        let mut pass = canvas.pass(true);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_bind_group(1, view, &[]);
        pass.draw(0..6, 0..lines * (per_line - 1));
    }

    /// Records one line through `points`.
    pub(super) fn record_from_host(&self, canvas: &mut Canvas<'_, '_>, points: &[LinePoint], paint: &Paint) {
        if points.len() < 2 {
            return;
        }
        let buffer = canvas.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("lines"),
            contents: bytemuck::cast_slice(points),
            usage: wgpu::BufferUsages::STORAGE,
        });
        self.record(canvas, &buffer, points.len() as u32, paint);
    }
}
