//! The head and what belongs to it, shaded plainly.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use wgpu::util::DeviceExt;

use super::DrawStage;
use crate::{Pose, groom::TriMesh, light::ambient::Surface};

/// The look of the body: matt with a soft gloss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMaterial {
    /// Albedo (linear) where the mesh has no vertex colours.
    pub color: Vec3,
    /// Strength of the gloss; 0 is chalk, 1 skin or plastic.
    pub gloss: f32,
    /// Sharpness of the gloss (the exponent).
    pub gloss_exponent: f32,
    /// How far light wraps around the edge of the shadow: 0 as on stone, 0.3 as on skin.
    pub wrap: f32,
}

impl Default for BodyMaterial {
    /// A matt mannequin of a greyish beige, quieter than any hair.
    fn default() -> Self {
        Self { color: Vec3::new(0.31, 0.27, 0.24), gloss: 0.25, gloss_exponent: 14.0, wrap: 0.2 }
    }
}

/// A mesh on the GPU.
#[derive(Debug)]
pub struct Body {
    vertices: wgpu::Buffer,
    triangles: wgpu::Buffer,
    index_count: u32,
    pub(crate) uniform: wgpu::Buffer,
    group: wgpu::BindGroup,
    pub(crate) surface: Surface,
    pub(crate) surface_group: wgpu::BindGroup,
}

/// What the shaders know of a body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct BodyUniform {
    /// Groom space to the world.
    pub pose: Mat4,
    /// [`BodyMaterial::color`].
    pub color: Vec3,
    /// [`BodyMaterial::gloss`].
    pub gloss: f32,
    /// [`BodyMaterial::wrap`].
    pub wrap: f32,
    /// [`BodyMaterial::gloss_exponent`].
    pub gloss_exponent: f32,
    /// [`Surface::outward`].
    pub outward: f32,
    /// Unused.
    pub _pad: f32,
}

/// A vertex of a body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct BodyVertex {
    position: Vec3,
    normal: Vec3,
    color: u32,
}

impl Body {
    pub(crate) const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<BodyVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4],
    };

    /// Uploads `mesh`, to be drawn by `stage`.
    pub fn new(device: &wgpu::Device, stage: &DrawStage, mesh: &TriMesh) -> Self {
        let vertices = vertices(mesh);
        let buffer = |label, contents: &[u8], usage| {
            // An empty buffer cannot be bound.
            let contents = if contents.is_empty() { &[0; 28] } else { contents };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        let uniform = crate::gpu::bindings::uniform(device, "body", size_of::<BodyUniform>());
        let vertices = buffer(
            "body vertices",
            bytemuck::cast_slice(&vertices),
            wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        );
        let surface = Surface::new(device, mesh, stage.ambient_cells());
        Self {
            surface_group: stage.bind_surface(device, [&uniform, &vertices, &surface.buffer]),
            surface,
            vertices,
            triangles: buffer(
                "body triangles",
                bytemuck::cast_slice(&mesh.triangles),
                wgpu::BufferUsages::INDEX,
            ),
            index_count: 3 * mesh.triangles.len() as u32,
            group: stage.bind_body(device, &uniform),
            uniform,
        }
    }

    /// Gives the vertices from `first` on the places, normals and colours of `part`'s, for the frames that are
    /// submitted from here on; its triangles are not read. What would lie beyond the last one is left out.
    pub fn move_part(&self, queue: &wgpu::Queue, first: usize, part: &TriMesh) {
        let offset = (first * size_of::<BodyVertex>()) as u64;
        let vertices = vertices(part);
        let bytes: &[u8] = bytemuck::cast_slice(&vertices);
        let room = self.vertices.size().saturating_sub(offset).min(bytes.len() as u64) as usize;
        queue.write_buffer(&self.vertices, offset, &bytes[..room]);
    }

    pub(crate) fn record(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.index_count, 0, 0..1);
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.vertices.size() + self.triangles.size() + self.uniform.size() + self.surface.buffer.size()
    }
}

/// As the shaders read them.
fn vertices(mesh: &TriMesh) -> Vec<BodyVertex> {
    let vertex = |(i, position): (usize, &Vec3)| BodyVertex {
        position: *position,
        normal: mesh.normals.get(i).copied().unwrap_or(Vec3::Y),
        color: mesh.colors.get(i).map_or(0, |color| crate::strands::strand::pack_color(*color)),
    };
    mesh.positions.iter().enumerate().map(vertex).collect()
}

impl BodyMaterial {
    pub(crate) fn uniform(&self, pose: &Pose, outward: f32) -> BodyUniform {
        BodyUniform {
            pose: pose.matrix(),
            color: self.color,
            gloss: self.gloss,
            wrap: self.wrap,
            gloss_exponent: self.gloss_exponent,
            outward,
            _pad: 0.0,
        }
    }
}
