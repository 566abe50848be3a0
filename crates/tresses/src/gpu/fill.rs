//! Contents of new memory. WebGPU clears buffers and textures; tests fill them with a pattern to show that nothing
//! depends on it.

use super::handle::Device;
use wgpu::util::DeviceExt;

/// Pattern that fills new memory: NaN as a 32-bit float and as two 16-bit floats, and a large integer.
pub(crate) const FILL_WORD: u32 = 0x7fff_7fff;

/// Value of new depth textures, which store no NaN.
const FILL_DEPTH: f32 = 0.37;

/// Labels of buffers and textures that must start at zero, and the reason of each.
pub(crate) const ZEROED: [(&str, &str); 15] = [
    // `draw::tiles`
    ("points", "no kernel writes the gaps between grooms; without a flag they hold no segment"),
    ("farthest bodies", "each frame takes a maximum; `draw::tiles::bound` resets it"),
    ("ranges of depth", "as farthest bodies; `draw::tiles::totals` resets them"),
    ("depths of lists", "0 for tiles whose previous frame is unknown"),
    // `wind`
    ("air", "the drag of the first step multiplies the old air by no hair"),
    ("air on faces", "as the air"),
    ("air pressure a", "pressure outside the grid is 0, and no kernel writes the rim"),
    ("air pressure b", "as air pressure a"),
    ("air give x", "faces outside the grid give nothing, and no kernel writes the rim"),
    ("air give y", "as air give x"),
    ("air give z", "as air give x"),
    // `volume`
    ("volume hair", "the air finds no hair before the first step fills it"),
    ("volume cells", "sums start at 0; `volume::sum` clears them again"),
    // `strands::buffers`
    ("strand widening", "0 is the width of full detail, for strands without levels of detail"),
    ("guide velocity", "hair starts at rest, and bends without twist"),
];

impl Device {
    /// As [`wgpu::Device::create_buffer`]. In tests the contents are [`FILL_WORD`] unless [`ZEROED`] lists the label.
    pub fn create_buffer(&self, descriptor: &wgpu::BufferDescriptor<'_>) -> wgpu::Buffer {
        let mappable = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE;
        if !self.fills(descriptor.label) || descriptor.usage.intersects(mappable) {
            return self.device.create_buffer(descriptor);
        }
        self.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: descriptor.label,
            contents: &pattern(descriptor.size),
            usage: descriptor.usage,
        })
    }

    /// As [`wgpu::Device::create_texture`]. In tests the contents are [`FILL_WORD`] unless [`ZEROED`] lists the label.
    /// Depth is 0.37.
    pub fn create_texture(&self, descriptor: &wgpu::TextureDescriptor<'_>) -> wgpu::Texture {
        let Some(queue) = self.fill.as_ref().filter(|_| self.fills(descriptor.label)) else {
            return self.device.create_texture(descriptor);
        };
        if descriptor.sample_count > 1 || descriptor.format.is_depth_stencil_format() {
            let texture = self.device.create_texture(descriptor);
            self.clear(queue, &texture);
            return texture;
        }
        let texel = u64::from(descriptor.format.block_copy_size(None).expect("a color format"));
        let bytes = |level| {
            let size = descriptor.mip_level_size(level).expect("a level of the texture");
            [size.width, size.height, size.depth_or_array_layers].map(u64::from).iter().product::<u64>()
                * texel
        };
        let bytes = pattern((0..descriptor.mip_level_count).map(bytes).sum());
        self.create_texture_with_data(queue, descriptor, wgpu::util::TextureDataOrder::LayerMajor, &bytes)
    }

    fn fills(&self, label: Option<&str>) -> bool {
        self.fill.is_some() && !ZEROED.iter().any(|(zeroed, _)| Some(*zeroed) == label)
    }

    /// Clears each layer of a texture that cannot be copied to.
    fn clear(&self, queue: &wgpu::Queue, texture: &wgpu::Texture) {
        let mut encoder = self.create_command_encoder(&Default::default());
        for layer in 0..texture.depth_or_array_layers() {
            let view = texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            });
            let is_depth = texture.format().is_depth_stencil_format();
            let nan = f64::from(f32::from_bits(FILL_WORD));
            let color = wgpu::Color { r: nan, g: nan, b: nan, a: nan };
            let color = super::commands::colored(&view, wgpu::LoadOp::Clear(color));
            let depth =
                wgpu::Operations { load: wgpu::LoadOp::Clear(FILL_DEPTH), store: wgpu::StoreOp::Store };
            let depth = super::commands::deep(&view, Some(depth));
            encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("fill"),
                color_attachments: if is_depth { &[] } else { std::slice::from_ref(&color) },
                depth_stencil_attachment: depth.filter(|_| is_depth),
                ..Default::default()
            });
        }
        queue.submit([encoder.finish()]);
    }
}

/// Returns `size` bytes of the pattern.
fn pattern(size: u64) -> Vec<u8> {
    FILL_WORD.to_le_bytes().into_iter().cycle().take(size as usize).collect()
}
