//! Render pipelines of this folder, by what differs between them.

use super::targets::{DEPTH_FORMAT, HDR_FORMAT};
use crate::shaders;

/// What a draw pipeline is made of.
pub(crate) struct Recipe<'a> {
    /// Module path of the shader.
    pub module: &'static str,
    /// Entry points of vertices and fragments.
    pub entry: [&'a str; 2],
    pub layouts: &'a [Option<&'a wgpu::BindGroupLayout>],
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    /// Whether depth is written and what it must be to what is there; reversed, so that nearer is
    /// greater. None without a depth target.
    pub depth: Option<(bool, wgpu::CompareFunction)>,
    pub samples: u32,
    pub alpha_to_coverage: bool,
}

impl Recipe<'_> {
    pub fn build(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(self.module),
            source: wgpu::ShaderSource::Wgsl(shaders::source(self.module).into()),
        });
        let [vertex, fragment] = self.entry;
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(fragment),
                bind_group_layouts: self.layouts,
                immediate_size: 0,
            })),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: self.buffers,
            },
            // Meshes in the wild are open and turned either way; strips face the camera.
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: self.depth.map(|(write, compare)| wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(write),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: self.samples,
                alpha_to_coverage_enabled: self.alpha_to_coverage,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: self.targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// The linear target, written to as `writes` says.
pub(crate) fn hdr(writes: wgpu::ColorWrites) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format: HDR_FORMAT, blend: None, write_mask: writes })
}

/// A target that is blended with `src` and `dst` factors, colour and alpha alike.
pub(crate) fn blended(
    format: wgpu::TextureFormat,
    src_factor: wgpu::BlendFactor,
    dst_factor: wgpu::BlendFactor,
) -> Option<wgpu::ColorTargetState> {
    let component = wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    Some(wgpu::ColorTargetState {
        format,
        blend: Some(wgpu::BlendState { color: component, alpha: component }),
        write_mask: wgpu::ColorWrites::ALL,
    })
}
