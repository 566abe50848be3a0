//! Host side of `volume.wesl`.

use super::{Canvas, GridView, Paint, overlay};
use crate::{
    Result,
    gpu::{Binding, Device, bindings::layout},
};

/// Pipeline of the ray march.
#[derive(Debug)]
pub(super) struct Volume {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl Volume {
    pub(super) fn new(device: &Device, format: wgpu::TextureFormat) -> Result<Self> {
        let entries =
            [Binding::Storage, Binding::Storage, Binding::Texture3d, Binding::Sampler, Binding::Depth];
        let layout = layout(device, "volume", wgpu::ShaderStages::FRAGMENT, &entries);
        let topology = wgpu::PrimitiveTopology::TriangleList;
        let pipeline = overlay(device, "views::volume", &[&layout], format, topology, false)?;
        Ok(Self { pipeline, layout })
    }

    pub(super) fn record(&self, canvas: &mut Canvas<'_, '_>, grid: &GridView<'_>, paint: &Paint) {
        let (paint, grid_uniform) = (canvas.paint(paint), canvas.grid(grid));
        let resources = [
            paint.as_entire_binding(),
            grid_uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(grid.texture),
            wgpu::BindingResource::Sampler(canvas.sampler),
            wgpu::BindingResource::TextureView(canvas.depth),
        ];
        let group = canvas.device.group("volume", &self.layout, &resources);
        let mut pass = canvas.pass(false);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
