//! Host side of `slices.wesl`.

use super::{Canvas, Grid, Paint, constant, overlay};
use crate::{
    Result,
    gpu::{Binding, Device, bindings::layout},
};
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// Which planes of a grid, and where they are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slices {
    /// Texture coordinates of the planes across x, y and z.
    pub at: Vec3,
    /// As a column of square panels on the picture instead of in the scene: the lower left corner
    /// of the first in clip space (xy, -1..1), the panels' height (z) and the way from one down
    /// to the next (w), both in clip space.
    pub panels: Option<Vec4>,
    /// Only the plane across this axis, over everything.
    pub facing: Option<u32>,
    /// From one line of equal value to the next, in the unit of what is shown; that of 0 is broad. 0
    /// for no lines.
    pub contours: f32,
}

impl Default for Slices {
    /// The mid planes, in the scene.
    fn default() -> Self {
        Self { at: Vec3::splat(0.5), panels: None, facing: None, contours: 0.0 }
    }
}

/// What the shader knows of [`Slices`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SliceUniform {
    /// [`Slices::at`].
    pub at: Vec3,
    /// 1 for panels, 0 for planes in the scene.
    pub panels: u32,
    /// [`Slices::panels`].
    pub panel: Vec4,
    /// [`Slices::contours`].
    pub contours: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// The pipelines: in the scene the body hides what is behind it, panels lie over everything.
#[derive(Debug)]
pub(super) struct SlicesPipeline {
    scene: wgpu::RenderPipeline,
    panels: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl SlicesPipeline {
    pub(super) fn new(
        device: &Device,
        view: &wgpu::BindGroupLayout,
        format: wgpu::TextureFormat,
    ) -> Result<Self> {
        use Binding::{Sampler, Storage, Texture3d};
        let entries = [Storage, Storage, Texture3d, Sampler, Storage];
        let layout = layout(device, "slices", wgpu::ShaderStages::VERTEX_FRAGMENT, &entries);
        let pipeline = |hidden| {
            let topology = wgpu::PrimitiveTopology::TriangleStrip;
            overlay(device, "views::slices", &[&layout, view], format, topology, hidden)
        };
        Ok(Self { scene: pipeline(true)?, panels: pipeline(false)?, layout })
    }

    pub(super) fn record(
        &self,
        canvas: &mut Canvas<'_, '_>,
        grid: &Grid<'_>,
        paint: &Paint,
        slices: &Slices,
    ) {
        let (paint, place) = (canvas.paint(paint), canvas.grid(grid));
        let uniform = constant(
            canvas.device,
            "slices",
            &SliceUniform {
                at: slices.at,
                panels: u32::from(slices.panels.is_some()),
                panel: slices.panels.unwrap_or_default(),
                contours: slices.contours,
                _pad: [0; 3],
            },
        );
        let resources = [
            paint.as_entire_binding(),
            place.as_entire_binding(),
            wgpu::BindingResource::TextureView(grid.texture),
            wgpu::BindingResource::Sampler(canvas.sampler),
            uniform.as_entire_binding(),
        ];
        let group = canvas.device.group("slices", &self.layout, &resources);
        let view = canvas.view;
        let over = slices.panels.is_some() || slices.facing.is_some();
        let mut pass = canvas.pass(!over);
        pass.set_pipeline(if over { &self.panels } else { &self.scene });
        pass.set_bind_group(0, &group, &[]);
        pass.set_bind_group(1, view, &[]);
        let planes = slices.facing.map_or(0..3, |axis| axis.min(2)..axis.min(2) + 1);
        pass.draw(0..4, planes);
    }
}
