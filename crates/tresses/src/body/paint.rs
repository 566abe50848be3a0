//! Material textures of a body on the GPU: two texture arrays with a layer per material, and texture coordinates.

use super::Body;
use crate::{
    Context, Error, Result,
    gpu::{Binding, bindings},
    groom::{
        mesh::{Paint, paint::Texture},
        srgb::linear,
    },
};
use bytemuck::NoUninit;
use wgpu::util::DeviceExt;

/// Vertex attributes of textured bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, NoUninit)]
struct PaintVertex {
    uv: [f32; 2],
    /// Bits 0 to 7: texture layer. Bits from 8: [`Coat::cutout`](crate::groom::mesh::paint::Coat::cutout) in 255ths.
    coat: u32,
}

/// Textures of a body. A clone refers to the same textures.
#[derive(Clone, Debug)]
pub(crate) struct BodyTextures {
    vertices: wgpu::Buffer,
    group: wgpu::BindGroup,
    bytes: u64,
}

impl BodyTextures {
    pub(crate) const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<PaintVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![3 => Float32x2, 4 => Uint32],
    };

    /// Binds the textures for [`Body::record`]: as `@group(3)` and the second vertex buffer.
    pub(super) fn bind(&self, pass: &mut crate::gpu::RenderPass<'_>) {
        pass.set_bind_group(3, &self.group, &[]);
        pass.set_vertex_buffer(1, self.vertices.slice(..));
    }

    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Body {
    /// Applies the material textures of the mesh that the body was created from. All must have the same
    /// size (`Paint::level`). They take 4 bytes per texel, and a third more for mip levels.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for the paint of another mesh and for textures of different sizes;
    /// [`Error::Limit`] if they are more or larger than the adapter supports.
    pub fn paint(&mut self, paint: &Paint) -> Result<()> {
        let count = (self.vertices.size() / (4 * u64::from(Self::WORDS))) as usize;
        if !paint.fits(count) || paint.coats.is_empty() {
            return Err(Error::unusable("the textures do not match the body's mesh"));
        }
        let cutout = |coat: u8| {
            let cutout = paint.coats.get(usize::from(coat)).and_then(|coat| coat.cutout);
            cutout.map_or(0, |threshold| (255.0 * threshold.clamp(0.0, 1.0)) as u32)
        };
        let vertex = |(uv, of): (&glam::Vec2, &u8)| PaintVertex {
            uv: uv.to_array(),
            coat: u32::from(*of) | cutout(*of) << 8,
        };
        let vertices: Vec<_> = paint.uvs.iter().zip(&paint.of).map(vertex).collect();
        let vertices = self.asset.context.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("painted vertices"),
            contents: bytemuck::cast_slice(&vertices),
            usage: wgpu::BufferUsages::VERTEX,
        });
        let bases: Vec<_> = paint.coats.iter().map(|coat| &coat.base).collect();
        let reliefs: Vec<_> = paint.coats.iter().map(|coat| &coat.relief).collect();
        let bases = layers(&self.asset.context, &bases, wgpu::TextureFormat::Rgba8UnormSrgb)?;
        let reliefs = layers(&self.asset.context, &reliefs, wgpu::TextureFormat::Rgba8Unorm)?;
        let views = [&bases, &reliefs].map(|texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            })
        });
        let sampler = self.asset.context.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("pictures"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let resources = [
            wgpu::BindingResource::TextureView(&views[0]),
            wgpu::BindingResource::TextureView(&views[1]),
            wgpu::BindingResource::Sampler(&sampler),
        ];
        let bytes = vertices.size() + bytes(&bases) + bytes(&reliefs);
        self.painted = Some(BodyTextures {
            vertices,
            group: self.asset.context.device.group("paint", &layout(&self.asset.context.device), &resources),
            bytes,
        });
        Ok(())
    }
}

/// Layout of `@group(3)` where textured bodies are drawn.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entries = [Binding::Texture2dArray, Binding::Texture2dArray, Binding::Sampler];
    bindings::layout(device, "paint", wgpu::ShaderStages::FRAGMENT, &entries)
}

/// Returns the bytes of a texture that [`layers`] created.
pub(crate) fn bytes(texture: &wgpu::Texture) -> u64 {
    let one = u64::from(texture.width()) * u64::from(texture.height());
    4 * one * u64::from(texture.depth_or_array_layers()) * 4 / 3
}

/// Creates a texture array from images of one size, with all mip levels.
pub(crate) fn layers(
    context: &Context,
    pictures: &[&Texture],
    format: wgpu::TextureFormat,
) -> Result<wgpu::Texture> {
    let Context { device, queue, .. } = context;
    let [width, height] = pictures.first().map_or([1; 2], |first| [first.width, first.height]);
    if pictures.iter().any(|picture| [picture.width, picture.height] != [width, height]) {
        return Err(Error::unusable("the textures of a body must have the same size"));
    }
    let limits = device.limits();
    for (need, have, unit) in [
        (width.max(height), limits.max_texture_dimension_2d, "texels along an edge"),
        (pictures.len() as u32, limits.max_texture_array_layers, "layers"),
    ] {
        if need > have {
            return Err(Error::Limit { what: "textures", need: need.into(), have: have.into(), unit });
        }
    }
    let levels = width.max(height).ilog2() + 1;
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("texture layers"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: pictures.len() as u32 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (layer, picture) in pictures.iter().enumerate() {
        let mut level = (*picture).clone();
        for mip_level in 0..levels {
            let copy = wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level,
                origin: wgpu::Origin3d { x: 0, y: 0, z: layer as u32 },
                aspect: wgpu::TextureAspect::All,
            };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * level.width),
                rows_per_image: Some(level.height),
            };
            let size = wgpu::Extent3d { width: level.width, height: level.height, depth_or_array_layers: 1 };
            queue.write_texture(copy, &level.rgba, layout, size);
            level = half(&level, format.is_srgb());
        }
    }
    Ok(texture)
}

/// Halves an image along both axes. Averages 2×2 texels, in linear light if `is_srgb`.
fn half(picture: &Texture, is_srgb: bool) -> Texture {
    let [width, height] = [picture.width, picture.height].map(|n| (n / 2).max(1));
    let table: [f32; 256] = std::array::from_fn(|byte| match is_srgb {
        true => linear(byte as f32 / 255.0),
        false => byte as f32 / 255.0,
    });
    // Finds the nearest byte; the table increases.
    let encoded = |light: f32| match is_srgb {
        true => {
            let above = table.partition_point(|of| *of < light).min(255);
            let below = above.saturating_sub(1);
            (if light - table[below] < table[above] - light { below } else { above }) as u8
        }
        false => (255.0 * light + 0.5) as u8,
    };
    let texels = picture.rgba.as_chunks::<4>().0;
    let mut rgba = Vec::with_capacity(4 * (width * height) as usize);
    for y in 0..height {
        for x in 0..width {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
                let [x, y] = [(2 * x + i).min(picture.width - 1), (2 * y + j).min(picture.height - 1)];
                texels[(y * picture.width + x) as usize]
            });
            let light =
                |k: usize| encoded(0.25 * four.iter().map(|texel| table[usize::from(texel[k])]).sum::<f32>());
            let alpha = four.iter().map(|texel| u32::from(texel[3])).sum::<u32>();
            rgba.extend([light(0), light(1), light(2), ((alpha + 2) / 4) as u8]);
        }
    }
    Texture { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mip_levels_average_linear_light() {
        let [black, white] = [[0, 0, 0, 255], [255, 255, 255, 0]];
        let picture = Texture { width: 4, height: 2, rgba: [black, white].concat().repeat(4) };
        let half_lit = half(&picture, true);
        assert_eq!((half_lit.width, half_lit.height), (2, 1));
        // Half of the light is 188 in sRGB.
        assert!(half_lit.rgba.chunks(4).all(|t| (187..=189).contains(&t[0]) && t[3] == 128), "{half_lit:?}");
        assert!(half(&picture, false).rgba.chunks(4).all(|t| t[0] == 128));
        assert_eq!(half(&half(&picture, true), true).rgba.len(), 4);
        let same = Texture { width: 3, height: 3, rgba: [7, 90, 201, 40].repeat(9) };
        assert_eq!(half(&same, true).rgba, [7, 90, 201, 40]);
    }
}
