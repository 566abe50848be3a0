//! Atlas of all distance fields: tiles of one 3-D texture.

use super::{FieldVolume, ShapeData};
use crate::{Context, Error, Result, gpu::Device};
use glam::{UVec3, Vec3};

/// Returns the positions of tiles of `sizes`, and the size of the texture; tiles are stacked along the axes that waste
/// least.
pub(super) fn pack(sizes: &[UVec3]) -> (Vec<UVec3>, UVec3) {
    const AXIS_ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let stack_permuted = |[x, y, z]: [usize; 3]| {
        let permute = |v: &UVec3| UVec3::new(v[x], v[y], v[z]);
        let back = |v: UVec3| {
            let mut restored = UVec3::ZERO;
            (restored[x], restored[y], restored[z]) = (v.x, v.y, v.z);
            restored
        };
        let (tiles, total_size) = stack(&sizes.iter().map(permute).collect::<Vec<_>>());
        (tiles.into_iter().map(back).collect(), back(total_size))
    };
    let packings = AXIS_ORDERS.into_iter().map(stack_permuted);
    packings.min_by_key(|(_, total_size)| total_size.as_u64vec3().element_product()).unwrap_or_default()
}

/// Packs tiles in rows along x, layers of rows along y, stacked along z; a layer is about as wide as high.
fn stack(sizes: &[UVec3]) -> (Vec<UVec3>, UVec3) {
    let volume: f64 = sizes.iter().map(|s| s.as_dvec3().element_product()).sum();
    let max_size = |axis: usize| sizes.iter().map(|s| s[axis]).max().unwrap_or(1);
    let side = volume.cbrt().ceil() as u32;
    let (width, height) = (side.max(max_size(0)), side.max(max_size(1)));
    let mut at = UVec3::ZERO;
    let (mut row, mut layer) = (0, 0);
    let mut total_size = UVec3::ONE;
    let positions = sizes.iter().map(|size| {
        if at.x + size.x > width {
            at = UVec3::new(0, at.y + row, at.z);
            row = 0;
        }
        if at.y + size.y > height {
            at = UVec3::new(0, 0, at.z + layer);
            (row, layer) = (0, 0);
        }
        let position = at;
        at.x += size.x;
        row = row.max(size.y);
        layer = layer.max(size.z);
        total_size = total_size.max(position + size);
        position
    });
    (positions.collect(), total_size)
}

/// The texture of all fields.
#[derive(Clone, Debug)]
pub(super) struct Atlas {
    pub texture: wgpu::Texture,
    pub size: UVec3,
}

impl Atlas {
    /// Creates an empty texture of `size`.
    ///
    /// # Errors
    /// [`Error::Colliders`] if the adapter does not support a texture of that size.
    pub fn new(device: &Device, size: UVec3) -> Result<Self> {
        let max_size = device.limits().max_texture_dimension_3d;
        if size.max_element() > max_size {
            return Err(Error::Colliders(format!(
                "their distance fields need a 3-D texture of {} x {} x {} texels, but this adapter allows {max_size} along an axis; use fewer or coarser fields",
                size.x, size.y, size.z
            )));
        }
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("collider fields"),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Ok(Self { texture, size })
    }

    /// Writes `volume` into the tile at `at`.
    pub fn write(&self, context: &Context, at: UVec3, volume: &FieldVolume) {
        let Context { queue, .. } = context;
        let mut copy = self.texture.as_image_copy();
        copy.origin = wgpu::Origin3d { x: at.x, y: at.y, z: at.z };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(volume.size.x * 8),
            rows_per_image: Some(volume.size.y),
        };
        queue.write_texture(copy, bytemuck::cast_slice(&volume.texels), layout, extent(volume.size));
    }

    /// Writes the texture coordinates of a field into `shape`. The field is a tile of `size` at `at` with tile
    /// coordinates `p * scale + bias`.
    pub fn write_coordinates(&self, shape: &mut ShapeData, at: UVec3, size: UVec3, bias: Vec3, scale: Vec3) {
        let atlas_size = self.size.as_vec3();
        let (at, size) = (at.as_vec3(), size.as_vec3());
        shape.scale = scale * size / atlas_size;
        shape.bias = (at + bias * size) / atlas_size;
        shape.low = (at + 0.5) / atlas_size;
        shape.high = (at + size - 0.5) / atlas_size;
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.size.as_u64vec3().element_product() * 8
    }
}

fn extent(size: UVec3) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_disjoint_and_compact() {
        let mut sizes = vec![UVec3::splat(64); 20];
        sizes.push(UVec3::new(71, 96, 80));
        sizes.extend(vec![UVec3::new(16, 20, 12); 30]);
        let (places, whole) = pack(&sizes);
        for (i, (a, size_a)) in places.iter().zip(&sizes).enumerate() {
            assert!((*a + *size_a).cmple(whole).all());
            for (b, size_b) in places[..i].iter().zip(&sizes) {
                let apart = (*a + *size_a).cmple(*b) | (*b + *size_b).cmple(*a);
                assert!(apart.any(), "{a} {b}");
            }
        }
        let used: u64 = sizes.iter().map(|s| s.as_u64vec3().element_product()).sum();
        assert!(whole.as_u64vec3().element_product() < 3 * used, "{whole}");
        assert_eq!(pack(&[]).1, UVec3::ONE);
        // The parts of the built-in character.
        let parts = [UVec3::new(50, 59, 47), UVec3::new(82, 32, 46), UVec3::new(86, 46, 41)];
        assert!(pack(&parts).1.element_product() * 10 < stack(&parts).1.element_product() * 9);
        assert_eq!(pack(&[UVec3::new(71, 96, 80)]), (vec![UVec3::ZERO], UVec3::new(71, 96, 80)));
    }
}
