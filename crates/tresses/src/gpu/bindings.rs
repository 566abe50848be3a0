//! Bind groups, their layouts, and the buffers in them.
//!
//! Kernels bind by name: `build/kernels.rs` generates a struct for the bindings of each, and [`Kernel::bind`] takes it.
//! Draw pipelines bind by position: the nth entry is `@binding(n)`.
//!
//! [`Kernel::bind`]: super::Kernel::bind
//!
//! **Uniforms and lavapipe.** Mesa's lavapipe (seen in 22.3.6: `lvp_inline_uniforms.c`) inlines uniforms that alone
//! decide loops and branches: it compiles a copy of the shader for each bind, and keeps all copies as long as the
//! pipeline lives. That costs 1 to 4 MB and some milliseconds per draw, without limit. The driver does not do so if
//! inlining hardly changes the shader. Affected shaders bind such values as [`Binding::Storage`] instead, which the
//! driver does not inline. `apps/cli/tests/command/memory.rs` tests this.

use super::{handle::Device, uniforms::Uniform};
use bytemuck::Pod;
use std::{marker::PhantomData, ops::Deref};
use wgpu::{
    BindingType, BufferBindingType, SamplerBindingType, TextureSampleType, TextureViewDimension,
    util::DeviceExt,
};

/// Type of the resource at one binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// `var<uniform>`.
    Uniform,
    /// `var<uniform>` with a dynamic offset.
    UniformDynamic,
    /// `var<storage, read>`.
    Storage,
    /// `var<storage, read_write>`.
    StorageMut,
    /// `texture_2d<f32>` of a filterable format.
    Texture2d,
    /// `texture_2d_array<f32>` of a filterable format.
    Texture2dArray,
    /// `texture_multisampled_2d<f32>`.
    TextureMultisampled,
    /// `texture_3d<f32>` of a filterable format.
    Texture3d,
    /// `texture_depth_2d`.
    Depth,
    /// `texture_depth_multisampled_2d`.
    DepthMultisampled,
    /// `texture_2d<f32>` of any format, read texel by texel.
    Texels2d,
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
            Self::StorageMut => buffer(BufferBindingType::Storage { read_only: false }, false),
            Self::Texture2d => texture(filterable, TextureViewDimension::D2, false),
            Self::Texture2dArray => texture(filterable, TextureViewDimension::D2Array, false),
            Self::TextureMultisampled => {
                texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::D2, true)
            }
            Self::Texture3d => texture(filterable, TextureViewDimension::D3, false),
            Self::Depth => texture(TextureSampleType::Depth, TextureViewDimension::D2, false),
            Self::DepthMultisampled => texture(TextureSampleType::Depth, TextureViewDimension::D2, true),
            Self::Texels2d => {
                texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::D2, false)
            }
            Self::DepthArray => texture(TextureSampleType::Depth, TextureViewDimension::D2Array, false),
            Self::Sampler => BindingType::Sampler(SamplerBindingType::Filtering),
            Self::Comparison => BindingType::Sampler(SamplerBindingType::Comparison),
        }
    }
}

/// The `@group(0)` of a kernel: one field per binding.
pub(crate) trait Bindings {
    /// Modules of the kernels that have these bindings.
    const MODULES: &'static [&'static str];
    /// Number and type of each binding.
    const LAYOUT: &'static [(u32, BindingType)];

    /// Returns the resources in the order of [`LAYOUT`](Self::LAYOUT).
    fn resources(&self) -> Vec<wgpu::BindingResource<'_>>;
}

/// A value that a kernel binds.
pub(crate) trait Resource {
    /// Returns the resource for an entry of a bind group.
    fn resource(&self) -> wgpu::BindingResource<'_>;
}

impl Resource for &wgpu::TextureView {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(self)
    }
}

impl Resource for &wgpu::Sampler {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Sampler(self)
    }
}

/// Element type of buffers that the compiler does not check: only shaders declare the content, or no other buffer has
/// its type.
#[derive(Debug)]
pub(crate) enum Opaque {}

/// A buffer or a part of it, with elements of `T`.
#[derive(Debug)]
pub(crate) struct BufferBinding<'a, T> {
    buffer: &'a wgpu::Buffer,
    offset: u64,
    size: Option<wgpu::BufferSize>,
    element: PhantomData<fn() -> T>,
}

impl<T> Clone for BufferBinding<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for BufferBinding<'_, T> {}

impl<'a, T> From<BufferBinding<'a, T>> for wgpu::BindingResource<'a> {
    fn from(BufferBinding { buffer, offset, size, .. }: BufferBinding<'a, T>) -> Self {
        Self::Buffer(wgpu::BufferBinding { buffer, offset, size })
    }
}

impl<T> Resource for BufferBinding<'_, T> {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        (*self).into()
    }
}

/// Binds a buffer without an element type: the caller ensures that the content has the type that the kernel declares.
pub(crate) trait BindBuffer {
    /// Binds the whole buffer.
    fn entire<T>(&self) -> BufferBinding<'_, T> {
        self.part(0, None)
    }

    /// Binds `size` bytes from byte `offset` on, or the rest of the buffer without `size`.
    fn part<T>(&self, offset: u64, size: Option<u64>) -> BufferBinding<'_, T>;
}

impl BindBuffer for wgpu::Buffer {
    fn part<T>(&self, offset: u64, size: Option<u64>) -> BufferBinding<'_, T> {
        let size = size.and_then(wgpu::BufferSize::new);
        BufferBinding { buffer: self, offset, size, element: PhantomData }
    }
}

impl BindBuffer for Uniform {
    fn part<T>(&self, offset: u64, size: Option<u64>) -> BufferBinding<'_, T> {
        let (buffer, range) = self.range(offset, size);
        buffer.part(range.start, Some(range.end - range.start))
    }
}

/// A buffer with elements of `T`. Kernels that read other elements from it do not compile.
#[derive(Debug)]
pub struct Buffer<T> {
    buffer: wgpu::Buffer,
    element: PhantomData<fn() -> T>,
}

impl<T> Buffer<T> {
    /// Binds the whole buffer.
    pub(crate) fn entire(&self) -> BufferBinding<'_, T> {
        self.buffer.entire()
    }
}

impl<T> From<wgpu::Buffer> for Buffer<T> {
    fn from(buffer: wgpu::Buffer) -> Self {
        Self { buffer, element: PhantomData }
    }
}

impl<T> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        self.buffer.clone().into()
    }
}

impl<T> Deref for Buffer<T> {
    type Target = wgpu::Buffer;

    fn deref(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

/// Creates a layout whose nth entry is `entries[n]`, visible to `stages`.
pub fn layout(
    device: &wgpu::Device,
    label: &str,
    stages: wgpu::ShaderStages,
    entries: &[Binding],
) -> wgpu::BindGroupLayout {
    numbered_layout(device, label, stages, (0..).zip(entries.iter().map(|entry| entry.ty())))
}

/// Creates a layout of bindings with their numbers, visible to `stages`.
pub(super) fn numbered_layout(
    device: &wgpu::Device,
    label: &str,
    stages: wgpu::ShaderStages,
    entries: impl Iterator<Item = (u32, BindingType)>,
) -> wgpu::BindGroupLayout {
    let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility: stages, ty, count: None };
    let entries: Vec<_> = entries.map(entry).collect();
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
    numbered_group(device, label, layout, &by_position(resources))
}

fn numbered_group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    entries: &[wgpu::BindGroupEntry<'_>],
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries })
}

fn by_position<'a>(resources: &[wgpu::BindingResource<'a>]) -> Vec<wgpu::BindGroupEntry<'a>> {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    (0..).zip(resources.iter().cloned()).map(entry).collect()
}

impl Device {
    /// Creates a bind group as [`group`] does, and reports the sizes of its buffers to the probe.
    pub fn group(
        &self,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        self.numbered_group(label, layout, &by_position(resources))
    }

    /// Creates a bind group as [`group`](Self::group) does, from resources with their binding numbers.
    pub(super) fn numbered_group(
        &self,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        entries: &[wgpu::BindGroupEntry<'_>],
    ) -> wgpu::BindGroup {
        let group = numbered_group(self, label, layout, entries);
        if let Some(probe) = &self.probe {
            let mut bytes = vec![0; entries.last().map_or(0, |last| last.binding as usize + 1)];
            for entry in entries {
                if let wgpu::BindingResource::Buffer(range) = &entry.resource {
                    bytes[entry.binding as usize] =
                        range.size.map_or(range.buffer.size() - range.offset, wgpu::BufferSize::get);
                }
            }
            probe.bound(&group, bytes);
        }
        group
    }
}

/// Creates a buffer of `size` bytes that is written through the queue, for values that are constant for a dispatch or
/// draw. Shaders bind it as `var<uniform>`, or as `var<storage, read>` if the values alone decide loops or branches.
pub fn uniform_buffer(device: &wgpu::Device, label: &str, size: usize) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Creates a buffer with a value that never changes. Bind groups keep it, unlike the slot of a [`Uniform`].
pub(crate) fn constant<T: Pod>(device: &wgpu::Device, label: &str, value: &T) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents: bytemuck::bytes_of(value),
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE,
    })
}

/// Creates a sampler with linear filtering and clamping, for grids.
pub fn linear_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("linear"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}
