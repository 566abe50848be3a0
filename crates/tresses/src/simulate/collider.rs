//! What strands collide with: one distance field, usually the head's, and any number of capsules.

use crate::{Pose, Result, groom::SdfGrid, strands::buffers::storage};
use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3, Vec4};
use half::f16;

/// A capsule: all points within `radius` of the segment from `a` to `b`. World space, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Capsule {
    /// One end of the axis.
    pub a: Vec3,
    /// The other end; equal to `a` for a sphere.
    pub b: Vec3,
    /// Radius, metres.
    pub radius: f32,
}

/// A capsule's motion over one frame, as the GPU reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CapsuleMotion {
    /// `a` at the begin of the frame, metres.
    pub a_begin: Vec3,
    /// Radius, metres.
    pub radius: f32,
    /// `b` at the begin of the frame.
    pub b_begin: Vec3,
    /// Unused.
    pub _pad0: f32,
    /// `a` at the end of the frame.
    pub a_end: Vec3,
    /// Unused.
    pub _pad1: f32,
    /// `b` at the end of the frame.
    pub b_end: Vec3,
    /// Unused.
    pub _pad2: f32,
}

impl CapsuleMotion {
    /// From `begin` to `end`; the radius is that of the end.
    pub fn new(begin: &Capsule, end: &Capsule) -> Self {
        Self {
            a_begin: begin.a,
            radius: end.radius,
            b_begin: begin.b,
            a_end: end.a,
            b_end: end.b,
            ..Self::zeroed()
        }
    }
}

/// A distance field as texels: the unit gradient (xyz) and the distance (w, metres).
#[derive(Clone, Debug)]
pub struct FieldVolume {
    /// Nodes along each axis.
    pub size: UVec3,
    /// Texture coordinate of the origin of the field's frame.
    pub bias: Vec3,
    /// Texture coordinates per metre.
    pub scale: Vec3,
    texels: Vec<[f16; 4]>,
}

impl FieldVolume {
    /// Distances and their gradients at the nodes of `grid`.
    pub fn new(grid: &SdfGrid) -> Self {
        let texels = (0..grid.size.x * grid.size.y * grid.size.z)
            .map(|i| {
                let n = grid.normal(grid.node(i));
                [n.x, n.y, n.z, grid.distances[i as usize]].map(f16::from_f32)
            })
            .collect();
        let size = grid.size.as_vec3();
        Self {
            size: grid.size,
            bias: (Vec3::splat(0.5) - grid.origin / grid.cell) / size,
            scale: 1.0 / (grid.cell * size),
            texels,
        }
    }

    /// What a trilinear sampler that clamps returns at texture coordinate `c`.
    pub fn sample(&self, c: Vec3) -> Vec4 {
        let last = (self.size - UVec3::ONE).as_vec3();
        let p = (c * self.size.as_vec3() - 0.5).clamp(Vec3::ZERO, last);
        let base = p.floor();
        let f = p - base;
        let base = base.as_uvec3();
        let at = |x: u32, y: u32, z: u32| {
            let i = (base + UVec3::new(x, y, z)).min(self.size - UVec3::ONE);
            let t = self.texels[(i.x + self.size.x * (i.y + self.size.y * i.z)) as usize];
            Vec4::from_array(t.map(f16::to_f32))
        };
        let row = |y, z| at(0, y, z).lerp(at(1, y, z), f.x);
        row(0, 0).lerp(row(1, 0), f.y).lerp(row(0, 1).lerp(row(1, 1), f.y), f.z)
    }
}

/// A distance field on the GPU.
#[derive(Debug)]
pub struct SdfCollider {
    pub(crate) view: wgpu::TextureView,
    pub(crate) bias: Vec3,
    pub(crate) scale: Vec3,
    bytes: u64,
}

impl SdfCollider {
    /// Uploads `grid`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the grid has more nodes along an axis than a texture may have.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, grid: &SdfGrid) -> Result<Self> {
        let most = device.limits().max_texture_dimension_3d;
        if grid.size.max_element() > most {
            return Err(crate::Error::Limit {
                what: "a collider's distance field",
                need: u64::from(grid.size.max_element()),
                have: u64::from(most),
            });
        }
        Ok(Self::upload(device, queue, &FieldVolume::new(grid)))
    }

    /// A field that nothing touches, to bind where there is none.
    pub(crate) fn none(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let far = FieldVolume {
            size: UVec3::ONE,
            bias: Vec3::ZERO,
            scale: Vec3::ONE,
            texels: vec![[f16::ZERO, f16::ONE, f16::ZERO, f16::from_f32(1e4)]],
        };
        Self::upload(device, queue, &far)
    }

    fn upload(device: &wgpu::Device, queue: &wgpu::Queue, volume: &FieldVolume) -> Self {
        let size = wgpu::Extent3d {
            width: volume.size.x,
            height: volume.size.y,
            depth_or_array_layers: volume.size.z,
        };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("collider field"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(&volume.texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(volume.size.x * 8),
                rows_per_image: Some(volume.size.y),
            },
            size,
        );
        Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            bias: volume.bias,
            scale: volume.scale,
            bytes: volume.texels.len() as u64 * 8,
        }
    }
}

/// The colliders of one groom.
#[derive(Debug)]
pub struct ColliderSet {
    /// The distance field's texture, or one that nothing touches.
    pub(crate) field: SdfCollider,
    pub(crate) has_field: bool,
    pub(crate) capsules: wgpu::Buffer,
    capacity: u32,
}

impl ColliderSet {
    /// A set with the given field and room for `capsules` capsules.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        field: Option<&SdfGrid>,
        capsules: u32,
    ) -> Result<Self> {
        Ok(Self {
            has_field: field.is_some(),
            field: match field {
                Some(grid) => SdfCollider::new(device, queue, grid)?,
                None => SdfCollider::none(device, queue),
            },
            capsules: storage::<CapsuleMotion>(device, "collider capsules", u64::from(capsules.max(1)))?,
            capacity: capsules,
        })
    }

    /// How many capsules there is room for.
    pub fn capacity(&self) -> u32 {
        self.capacity
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.field.bytes + self.capsules.size()
    }
}

/// Where the colliders are in a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColliderPoses {
    /// Pose of the distance field relative to the head; `None` when its frame is the head's.
    pub field: Option<Pose>,
    /// The capsules, world space, in the same order in every frame.
    pub capsules: Vec<Capsule>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_volume_samples_like_the_grid() {
        let grid = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::new(0.2, 0.25, 0.2), 41, |p| p.length() - 0.1);
        let volume = FieldVolume::new(&grid);
        for p in [Vec3::new(0.1, 0.02, 0.03), Vec3::new(-0.05, 0.11, 0.0), Vec3::new(0.0, -0.1, 0.1)] {
            let sample = volume.sample(p * volume.scale + volume.bias);
            assert!((sample.w - grid.sample(p)).abs() < 1e-4, "{p}");
            assert!(sample.truncate().normalize().dot(p.normalize()) > 0.999, "{p}");
        }
    }
}
