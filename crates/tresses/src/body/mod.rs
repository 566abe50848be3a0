//! The head and what belongs to it, shaded plainly: a mesh on the GPU that light falls on and that throws some back.

mod surface;

pub use surface::Surface;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use wgpu::util::DeviceExt;

use crate::{
    Pose,
    gpu::{
        Binding,
        bindings::{self, group},
    },
    groom::TriMesh,
};

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
    /// How it looks.
    pub material: BodyMaterial,
    /// Where it is.
    pub pose: Pose,
    vertices: wgpu::Buffer,
    triangles: wgpu::Buffer,
    index_count: u32,
    uniform: wgpu::Buffer,
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

    /// Uploads `mesh`, at the origin.
    pub fn new(device: &wgpu::Device, mesh: &TriMesh) -> Self {
        Self::for_cells(device, mesh, u32::MAX)
    }

    /// [`new`](Self::new) for views whose grids of light have at most `cells` along each edge
    /// ([`ViewOptions::ambient_cells`](crate::view::ViewOptions::ambient_cells)): coarse ones ask fewer points of it.
    pub fn for_cells(device: &wgpu::Device, mesh: &TriMesh, cells: u32) -> Self {
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
        let uniform = bindings::uniform(device, "body", size_of::<BodyUniform>());
        let vertices = buffer(
            "body vertices",
            bytemuck::cast_slice(&vertices),
            wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        );
        let surface = Surface::new(device, mesh, cells);
        let buffers = [&uniform, &vertices, &surface.buffer].map(wgpu::Buffer::as_entire_binding);
        Self {
            material: BodyMaterial::default(),
            pose: Pose::IDENTITY,
            surface_group: group(device, "surface", &surface_layout(device), &buffers),
            surface,
            vertices,
            triangles: buffer(
                "body triangles",
                bytemuck::cast_slice(&mesh.triangles),
                wgpu::BufferUsages::INDEX,
            ),
            index_count: 3 * mesh.triangles.len() as u32,
            group: group(device, "body", &layout(device), &[uniform.as_entire_binding()]),
            uniform,
        }
    }

    /// Writes where it is and how it looks, for the frame that is recorded.
    pub(crate) fn prepare(&self, queue: &wgpu::Queue) {
        let uniform = self.material.uniform(&self.pose, self.surface.outward);
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
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

/// The layout of a body's group, `@group(1)` wherever one is drawn.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    bindings::layout(device, "body", wgpu::ShaderStages::VERTEX_FRAGMENT, &[Binding::Uniform])
}

/// The layout of the group of its surface, `@group(1)` of the kernels that ask its points.
pub(crate) fn surface_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entries = [Binding::Uniform, Binding::Storage, Binding::Storage];
    bindings::layout(device, "surface", wgpu::ShaderStages::COMPUTE, &entries)
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
    fn uniform(&self, pose: &Pose, outward: f32) -> BodyUniform {
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
