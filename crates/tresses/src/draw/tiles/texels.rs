//! What some kernels write and others read much, as a texture.

use crate::{
    Result,
    constants::TILE_POINTS,
    gpu::commands::{self, Commands},
};

/// Values in a texture, rows of [`TILE_POINTS`] of them: software drivers load texels many lanes at a time, but words of a
/// buffer lane by lane. A kernel writes them, or they are copied from a buffer.
#[derive(Debug)]
pub(super) struct Texels {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Texels {
    /// Room for `count` values of `format`, all zero.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(
        device: &wgpu::Device,
        label: &'static str,
        count: u64,
        format: wgpu::TextureFormat,
    ) -> Result<Self> {
        let rows = count.div_ceil(u64::from(TILE_POINTS)).max(1);
        let most = device.limits().max_texture_dimension_2d.into();
        if rows > most {
            return Err(crate::Error::Limit { what: label, need: rows, have: most });
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
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self { view: texture.create_view(&Default::default()), texture })
    }

    /// Room in a buffer for `count` values that are to be [copied](Self::copy): whole rows.
    pub fn rows(count: u64) -> u64 {
        count.next_multiple_of(u64::from(TILE_POINTS)).max(u64::from(TILE_POINTS))
    }

    /// Records that the first `count` values are those of a buffer with [room](Self::rows) for them.
    pub fn copy(&self, commands: &mut Commands<'_>, buffer: &wgpu::Buffer, count: u32) {
        commands.copy_rows(buffer, &self.texture, count.div_ceil(TILE_POINTS));
    }

    /// A texture that the values of this one can be [kept](Self::keep) in.
    pub fn like(&self, device: &wgpu::Device, label: &'static str) -> wgpu::Texture {
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

    /// Records that `other` has what the texture has.
    pub fn keep(&self, commands: &mut Commands<'_>, other: &wgpu::Texture) {
        commands.copy_texture(&self.texture, other);
    }

    /// For who reads or writes it.
    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.view)
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        commands::bytes(&self.texture)
    }
}
