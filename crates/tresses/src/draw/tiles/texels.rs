//! Arrays stored as textures, for values that kernels read often.

use crate::{
    Result,
    constants::{TEXEL_SQUARE, TILE_POINTS},
    gpu::{
        Device,
        commands::{self, Commands},
    },
};

/// An array in a texture of [`TILE_POINTS`] texels per row; `grid::texel_of` maps an index to a texel. Software drivers load texels for many lanes at a time,
/// but buffer words lane by lane.
#[derive(Debug)]
pub(crate) struct Texels {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Texels {
    /// Creates an array of `count` values of `format`, all zero.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the texture would have more rows than the device allows.
    pub fn new(
        device: &Device,
        label: &'static str,
        count: u64,
        format: wgpu::TextureFormat,
    ) -> Result<Self> {
        let square = if device.is_gpu { u64::from(TEXEL_SQUARE) } else { 1 };
        let rows = square * count.div_ceil(square * u64::from(TILE_POINTS)).max(1);
        let max_rows = device.limits().max_texture_dimension_2d.into();
        if rows > max_rows {
            return Err(crate::Error::Limit {
                what: label,
                need: rows,
                have: max_rows,
                unit: "rows of texels",
            });
        }
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: TILE_POINTS, height: rows as u32, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self { view: texture.create_view(&Default::default()), texture })
    }

    /// Creates a texture that [`keep`](Self::keep) can copy this one to.
    pub fn like(&self, device: &Device, label: &'static str) -> wgpu::Texture {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: self.texture.size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.texture.format(),
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    }

    /// Copies the array to `other`.
    pub fn keep(&self, commands: &mut Commands<'_>, other: &wgpu::Texture) {
        commands.copy_texture(&self.texture, other);
    }

    /// Returns the texture for binding.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        commands::bytes(&self.texture)
    }
}
