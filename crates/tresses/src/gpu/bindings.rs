//! Bind group layouts by position: the nth entry is `@binding(n)`.
//!
//! **Uniforms and lavapipe.** Mesa's lavapipe (seen in 22.3.6: `lvp_inline_uniforms.c`) inlines uniforms that alone
//! decide loops and branches: it compiles a copy of the shader for each bind, and keeps all copies as long as the
//! pipeline lives. That costs 1 to 4 MB and some milliseconds per draw, without limit. The driver does not do so if
//! inlining hardly changes the shader. Affected shaders bind such values as [`Binding::Storage`] instead, which the
//! driver does not inline. `apps/cli/tests/command/memory.rs` tests this.

use super::handle::Device;
use wgpu::{BindingType, BufferBindingType, SamplerBindingType, TextureSampleType, TextureViewDimension};

/// Type of the resource at one binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// `var<uniform>`.
    Uniform,
    /// `var<uniform>` with a dynamic offset.
    UniformDynamic,
    /// `var<storage, read>`.
    Storage,
    /// `var<storage, read>` with a dynamic offset.
    StorageDynamic,
    /// `var<storage, read_write>`.
    StorageMut,
    /// `texture_2d<f32>` of a filterable format.
    Texture2d,
    /// `texture_2d_array<f32>` of a filterable format.
    Texture2dArray,
    /// `texture_cube<f32>` of a filterable format.
    Cube,
    /// `texture_multisampled_2d<f32>`.
    TextureMultisampled,
    /// `texture_3d<f32>` of a filterable format.
    Texture3d,
    /// `texture_depth_2d`.
    Depth,
    /// `texture_depth_multisampled_2d`.
    DepthMultisampled,
    /// `texture_storage_2d<rgba16float, write>`.
    Write2d,
    /// `texture_storage_2d<rgba32float, write>`.
    WriteFloats2d,
    /// `texture_storage_2d<r32uint, write>`.
    WriteWords2d,
    /// `texture_storage_3d<rgba16float, write>`.
    Write3d,
    /// `texture_2d<f32>` of any format, read texel by texel.
    Texels2d,
    /// `texture_2d<u32>`.
    Words2d,
    /// `texture_3d<f32>` of any format, read texel by texel.
    Texels3d,
    /// `texture_storage_3d<rgba32float, write>`.
    WriteFull3d,
    /// `texture_3d<u32>`.
    Words3d,
    /// `texture_storage_3d<rgba32uint, write>`.
    WriteWords3d,
    /// `texture_depth_2d_array`.
    DepthArray,
    /// Filtering `sampler`.
    Sampler,
    /// `sampler_comparison`.
    Comparison,
}

impl Binding {
    fn ty(self) -> BindingType {
        let buffer =
            |ty, has_dynamic_offset| BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None };
        let texture = |sample_type, view_dimension, multisampled| BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled,
        };
        let filterable = TextureSampleType::Float { filterable: true };
        match self {
            Self::Uniform => buffer(BufferBindingType::Uniform, false),
            Self::UniformDynamic => buffer(BufferBindingType::Uniform, true),
            Self::Storage => buffer(BufferBindingType::Storage { read_only: true }, false),
            Self::StorageDynamic => buffer(BufferBindingType::Storage { read_only: true }, true),
            Self::StorageMut => buffer(BufferBindingType::Storage { read_only: false }, false),
            Self::Texture2d => texture(filterable, TextureViewDimension::D2, false),
            Self::Texture2dArray => texture(filterable, TextureViewDimension::D2Array, false),
            Self::Cube => texture(filterable, TextureViewDimension::Cube, false),
            Self::TextureMultisampled => {
                texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::D2, true)
            }
            Self::Texture3d => texture(filterable, TextureViewDimension::D3, false),
            Self::Depth => texture(TextureSampleType::Depth, TextureViewDimension::D2, false),
            Self::DepthMultisampled => texture(TextureSampleType::Depth, TextureViewDimension::D2, true),
            Self::Write2d => BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: wgpu::TextureFormat::Rgba16Float,
                view_dimension: TextureViewDimension::D2,
            },
            Self::WriteFloats2d => BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: wgpu::TextureFormat::Rgba32Float,
                view_dimension: TextureViewDimension::D2,
            },
            Self::WriteWords2d => BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: wgpu::TextureFormat::R32Uint,
                view_dimension: TextureViewDimension::D2,
            },
            Self::Write3d => BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: wgpu::TextureFormat::Rgba16Float,
                view_dimension: TextureViewDimension::D3,
            },
            Self::Texels2d => {
                texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::D2, false)
            }
            Self::Words2d => texture(TextureSampleType::Uint, TextureViewDimension::D2, false),
            Self::Texels3d => {
                texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::D3, false)
            }
            Self::WriteFull3d => BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: wgpu::TextureFormat::Rgba32Float,
                view_dimension: TextureViewDimension::D3,
            },
            Self::Words3d => texture(TextureSampleType::Uint, TextureViewDimension::D3, false),
            Self::WriteWords3d => BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: wgpu::TextureFormat::Rgba32Uint,
                view_dimension: TextureViewDimension::D3,
            },
            Self::DepthArray => texture(TextureSampleType::Depth, TextureViewDimension::D2Array, false),
            Self::Sampler => BindingType::Sampler(SamplerBindingType::Filtering),
            Self::Comparison => BindingType::Sampler(SamplerBindingType::Comparison),
        }
    }
}

/// Creates a layout whose nth entry is `entries[n]`, visible to `stages`.
pub fn layout(
    device: &wgpu::Device,
    label: &str,
    stages: wgpu::ShaderStages,
    entries: &[Binding],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = entries
        .iter()
        .enumerate()
        .map(|(binding, entry)| wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility: stages,
            ty: entry.ty(),
            count: None,
        })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Creates a bind group whose nth resource is `resources[n]`.
pub fn group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .enumerate()
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding: binding as u32,
            resource: resource.clone(),
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

impl Device {
    /// As [`group`], and notifies the probe.
    pub fn group(
        &self,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let group = group(self, label, layout, resources);
        if let Some(probe) = &self.probe {
            let bytes = |resource: &wgpu::BindingResource<'_>| match resource {
                wgpu::BindingResource::Buffer(part) => {
                    part.size.map_or(part.buffer.size() - part.offset, wgpu::BufferSize::get)
                }
                _ => 0,
            };
            probe.bound(&group, resources.iter().map(bytes).collect());
        }
        group
    }
}

/// Creates a buffer of `size` bytes that is written through the queue, for values that are constant for a dispatch or
/// draw. Shaders bind it as `var<uniform>`, or as `var<storage, read>` if the values alone decide loops or branches.
pub fn uniform(device: &wgpu::Device, label: &str, size: usize) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Creates a sampler with linear filtering and clamping, as all grids use.
pub fn linear(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("linear"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}
