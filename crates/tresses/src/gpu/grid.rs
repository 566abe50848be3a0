//! Three-dimensional textures for grids that kernels write and read.

use super::Device;

/// Creates a texture of `size` cells, in a `format` that allows storage writes. Its contents can be copied out.
pub(crate) fn grid_texture(
    device: &Device,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height, depth_or_array_layers]: [u32; 3],
) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    (texture, view)
}
