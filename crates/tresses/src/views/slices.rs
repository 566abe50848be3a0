//! Host side of `slices.wesl`.

use super::{Canvas, GridView, Paint, constant, overlay};
use crate::{
    Result,
    gpu::{Binding, Device, bindings::layout},
};
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// Planes through a grid, and their placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slices {
    /// Texture coordinates of the planes across x, y and z.
    pub at: Vec3,
    /// Places the planes as a column of square panels on the frame, instead of in the scene. All values are in clip
    /// space: lower left corner of the first panel (xy, -1..1), height of the panels (z), step down from one panel to
    /// the next (w).
    pub panels: Option<Vec4>,
    /// Draws only the plane across this axis, over everything.
    pub facing: Option<u32>,
    /// Interval between contour lines, in the unit of the quantity; 0 for no lines. The line at 0 is wide.
    pub contours: f32,
}

impl Default for Slices {
    /// The mid planes, in the scene.
    fn default() -> Self {
        Self { at: Vec3::splat(0.5), panels: None, facing: None, contours: 0.0 }
    }
}

/// Shader data of [`Slices`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct SliceUniform {
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

/// Pipelines. Meshes occlude planes in the scene; panels are over everything.
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
        grid: &GridView<'_>,
        paint: &Paint,
        slices: &Slices,
    ) {
        let (paint, grid_uniform) = (canvas.paint(paint), canvas.grid(grid));
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
            grid_uniform.as_entire_binding(),
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
