//! Cards on the GPU: the strips between two strands of a groom, and their texture.

use crate::{
    Context, Result,
    body::paint,
    gpu::{Binding, bindings},
    groom::card_sheet::{CardSheet, CardStrip},
    strands::buffers::storage,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec2;

/// The part of a card between two strands.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CardStripData {
    /// Index of the strand on the left edge.
    pub left: u32,
    /// Index of the strand on the right edge.
    pub right: u32,
    /// Texture coordinates of the left edge at the root.
    pub left_root: Vec2,
    /// Texture coordinates of the right edge at the root.
    pub right_root: Vec2,
    /// Texture coordinates of the left edge at the tip.
    pub left_tip: Vec2,
    /// Texture coordinates of the right edge at the tip.
    pub right_tip: Vec2,
    /// Factor on the color of the texture.
    pub gain: f32,
    /// Unused.
    pub _pad: u32,
}

/// The cards of a groom whose strands are the columns of cards.
#[derive(Debug)]
pub(crate) struct CardBuffers {
    group: wgpu::BindGroup,
    /// Number of strips.
    strips: u32,
    bytes: u64,
}

/// Returns the layout of `@group(2)` where cards are drawn.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entries = [Binding::Storage, Binding::Texture2dArray, Binding::Sampler];
    bindings::layout(device, "cards", wgpu::ShaderStages::VERTEX_FRAGMENT, &entries)
}

impl CardBuffers {
    /// Uploads the strips of `sheet`, whose strands are numbered as on the GPU, and its texture.
    ///
    /// # Errors
    /// [`Error::Limit`](crate::Error::Limit).
    pub fn new(context: &Context, strips: &[CardStrip], sheet: &CardSheet) -> Result<Self> {
        let Context { device, queue, .. } = context;
        let strip = |strip: &CardStrip| CardStripData {
            left: strip.columns[0],
            right: strip.columns[1],
            left_root: strip.roots[0],
            right_root: strip.roots[1],
            left_tip: strip.tips[0],
            right_tip: strip.tips[1],
            gain: sheet.gain,
            _pad: 0,
        };
        let data: Vec<_> = strips.iter().map(strip).collect();
        let strips = storage::<CardStripData>(device, "card strips", data.len() as u64)?;
        queue.write_buffer(&strips, 0, bytemuck::cast_slice(&data));
        let texture = paint::layers(context, &[&sheet.texture], wgpu::TextureFormat::Rgba8UnormSrgb)?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("cards"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let resources = [
            strips.as_entire_binding(),
            wgpu::BindingResource::TextureView(&view),
            wgpu::BindingResource::Sampler(&sampler),
        ];
        Ok(Self {
            group: device.group("cards", &layout(device), &resources),
            strips: data.len() as u32,
            bytes: strips.size() + paint::bytes(&texture),
        })
    }

    /// Records all strips, in their order, with `rows` vertices along each edge. The caller has set the pipeline and the
    /// groups of the frame and the hair.
    pub fn record(&self, pass: &mut crate::gpu::RenderPass<'_>, rows: u32) {
        pass.set_bind_group(2, &self.group, &[]);
        pass.draw(0..6 * rows.saturating_sub(1), 0..self.strips);
    }

    /// Number of triangles, with `rows` vertices along each edge.
    pub fn triangles(&self, rows: u32) -> u64 {
        u64::from(self.strips) * 2 * u64::from(rows.saturating_sub(1))
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}
