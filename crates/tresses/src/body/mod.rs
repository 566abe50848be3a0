//! The head and what belongs to it, shaded plainly: a mesh on the GPU that light falls on and that throws some back.

pub(crate) mod paint;
mod skin;
mod surface;

pub(crate) use paint::Painted;
pub use skin::{Skin, Words};
pub use surface::Surface;
pub(crate) use surface::points_for;

use bytemuck::{NoUninit, Pod, Zeroable};
use glam::{Mat4, Vec3};
use std::ops::Range;
use wgpu::util::DeviceExt;

use crate::{
    Camera, Context, Pose,
    gpu::{Binding, bindings},
    groom::{TriMesh, mesh::Level},
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
    context: Context,
    /// How it looks.
    pub material: BodyMaterial,
    /// Where it is.
    pub pose: Pose,
    vertices: wgpu::Buffer,
    triangles: wgpu::Buffer,
    /// Where the triangles of each level are, the mesh's own first, and how far they stray, metres.
    levels: Vec<(f32, Range<u32>)>,
    /// Two corners of a box around the mesh, metres: as it was made, or as it was said since.
    bounds: [Vec3; 2],
    uniform: wgpu::Buffer,
    group: wgpu::BindGroup,
    pub(crate) surface: Surface,
    pub(crate) surface_group: wgpu::BindGroup,
    /// The pictures of its materials, where it [is painted](Self::paint).
    painted: Option<Painted>,
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
#[derive(Clone, Copy, Debug, NoUninit)]
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

    /// Uploads `mesh`, at the origin, and its [`levels`](TriMesh::levels): it is drawn with as few triangles as no pixel
    /// shows. They take a quarter of a second for 100,000 triangles; who makes a body of the same mesh again keeps them
    /// for [`with_levels`](Self::with_levels).
    pub fn new(context: &Context, mesh: &TriMesh) -> Self {
        Self::with_levels(context, mesh, &mesh.levels(), u32::MAX)
    }

    /// [`new`](Self::new) with such levels as there are, ever coarser, for views whose grids of light have at most `cells`
    /// along each edge ([`ViewOptions::ambient_cells`](crate::view::ViewOptions::ambient_cells)): coarse ones ask fewer
    /// points of it.
    pub fn with_levels(context: &Context, mesh: &TriMesh, levels: &[Level], cells: u32) -> Self {
        let Context { device, .. } = context;
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
            wgpu::BufferUsages::VERTEX
                | wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
        );
        let surface = Surface::new(device, mesh, cells);
        let (mut triangles, mut ranges) = (Vec::new(), Vec::new());
        let own = (0.0, &mesh.triangles);
        for (stray, level) in std::iter::once(own).chain(levels.iter().map(|l| (l.stray, &l.triangles))) {
            let first = triangles.len() as u32;
            triangles.extend_from_slice(level.as_flattened());
            ranges.push((stray, first..triangles.len() as u32));
        }
        let buffers = [&uniform, &vertices, &surface.buffer].map(wgpu::Buffer::as_entire_binding);
        Self {
            context: context.clone(),
            material: BodyMaterial::default(),
            pose: Pose::IDENTITY,
            surface_group: device.group("surface", &surface_layout(device), &buffers),
            surface,
            vertices,
            triangles: buffer("body triangles", bytemuck::cast_slice(&triangles), wgpu::BufferUsages::INDEX),
            levels: ranges,
            bounds: mesh.bounds().map_or([Vec3::ZERO; 2], |(lo, hi)| [lo, hi]),
            group: device.group("body", &layout(device), &[uniform.as_entire_binding()]),
            uniform,
            painted: None,
        }
    }

    /// Another body of the same mesh, which both share on the GPU: who bends one bends both.
    pub fn another(&self) -> Self {
        self.with_vertices(self.vertices.clone())
    }

    fn with_vertices(&self, vertices: wgpu::Buffer) -> Self {
        let device = &self.context.device;
        let uniform = bindings::uniform(device, "body", size_of::<BodyUniform>());
        let buffers = [&uniform, &vertices, &self.surface.buffer].map(wgpu::Buffer::as_entire_binding);
        Self {
            surface_group: device.group("surface", &surface_layout(device), &buffers),
            surface: self.surface.clone(),
            vertices,
            triangles: self.triangles.clone(),
            levels: self.levels.clone(),
            group: device.group("body", &layout(device), &[uniform.as_entire_binding()]),
            uniform,
            painted: self.painted.clone(),
            context: self.context.clone(),
            ..*self
        }
    }

    /// Another body of the same mesh with vertices of its own, as they are now: it may be deformed alone.
    pub fn unshared(&self) -> Self {
        let Context { device, queue, .. } = &self.context;
        let vertices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("body vertices"),
            size: self.vertices.size(),
            usage: self.vertices.usage(),
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.vertices, 0, &vertices, 0, None);
        queue.submit([encoder.finish()]);
        self.with_vertices(vertices)
    }

    /// Words of a vertex in [`vertices`](Self::vertices): its position, its normal, its colour.
    pub const WORDS: u32 = (size_of::<BodyVertex>() / 4) as u32;

    /// Its vertices, [`WORDS`](Self::WORDS) words each: three floats of position (metres), three of normal, four bytes of
    /// colour. Who bends the body writes them.
    pub fn vertices(&self) -> &wgpu::Buffer {
        &self.vertices
    }

    /// From here on its vertices lie within a box with these corners, in its own space, metres.
    pub fn set_bounds(&mut self, corners: [Vec3; 2]) {
        self.bounds = corners;
    }

    /// Writes where it is and how it looks, for the frame that is recorded.
    pub(crate) fn prepare(&self) {
        let uniform = self.material.uniform(&self.pose, self.surface.outward);
        self.context.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// Gives its vertices the places, normals and colours of `mesh`'s, for the frames that are submitted from here on;
    /// its triangles are not read. What would lie beyond the last one is left out. How far a level strays is that of the
    /// mesh that the body was made of: one that changes its shape or leaves its place is made without levels.
    pub fn move_to(&self, mesh: &TriMesh) {
        let vertices = vertices(mesh);
        let bytes: &[u8] = bytemuck::cast_slice(&vertices);
        let room = self.vertices.size().min(bytes.len() as u64) as usize;
        self.context.queue.write_buffer(&self.vertices, 0, &bytes[..room]);
    }

    /// The least clip coordinate `w` of its points for `camera`: for a perspective one, how far the nearest of them is,
    /// metres.
    pub(crate) fn nearest(&self, camera: &Camera) -> f32 {
        let w = (camera.projection * camera.view * self.pose.matrix()).row(3);
        // A box has no point nearer than the one of its corners that faces the camera.
        let [lo, hi] = self.bounds;
        let corner = Vec3::select(w.truncate().cmplt(Vec3::ZERO), hi, lo);
        w.dot(corner.extend(1.0)).max(0.0)
    }

    /// The corners of a box around it, world space.
    pub(crate) fn corners(&self) -> impl Iterator<Item = Vec3> {
        let [lo, hi] = self.bounds;
        (0..8).map(move |i| {
            let upper = glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0);
            self.pose.point(Vec3::select(upper, hi, lo))
        })
    }

    /// Whether it is drawn with its paint.
    pub(crate) fn is_painted(&self) -> bool {
        self.painted.is_some()
    }

    /// [`record`](Self::record) with its paint, where there is some.
    pub(crate) fn record_painted(&self, pass: &mut crate::gpu::RenderPass<'_>, stray: f32) {
        if let Some(painted) = &self.painted {
            painted.bind(pass);
            self.record(pass, stray);
        }
    }

    /// Draws it with as few triangles as there are that stray by `stray` metres at most.
    pub(crate) fn record(&self, pass: &mut crate::gpu::RenderPass<'_>, stray: f32) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(self.level(stray), 0, 0..1);
    }

    /// Where the triangles of that level are: the mesh's own if nothing may stray so little, such as less than nothing.
    fn level(&self, stray: f32) -> Range<u32> {
        let level = self.levels.iter().rev().find(|(strays, _)| *strays <= stray);
        level.unwrap_or(&self.levels[0]).1.clone()
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.uniform.size() + self.shared_bytes()
    }

    /// Bytes of it that [others](Self::another) of the same mesh share.
    pub fn shared_bytes(&self) -> u64 {
        let painted = self.painted.as_ref().map_or(0, Painted::bytes);
        self.vertices.size() + self.triangles.size() + self.surface.buffer.size() + painted
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn a_body_is_drawn_however_little_it_may_stray() {
        let context = &crate::gpu::noop();
        let mesh = TriMesh { triangles: vec![[0, 1, 2], [2, 1, 3]], ..Default::default() };
        let levels = [Level { stray: 1e-3, triangles: vec![[0, 1, 3]] }];
        let body = Body::with_levels(context, &mesh, &levels, 4);
        let drawn = [1.0, 1e-3, 5e-4, 0.0, -1.0, f32::NAN].map(|stray| body.level(stray));
        assert_eq!(drawn, [6..9, 6..9, 0..6, 0..6, 0..6, 0..6]);
    }

    #[test]
    fn nearest_is_the_nearest_corner_of_a_box() {
        let context = &crate::gpu::noop();
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let positions: Vec<_> = (0..8).map(|i| Vec3::new(0.3, 0.1, -0.2) + 0.5 * corner(i)).collect();
        let mesh = TriMesh { positions, triangles: vec![[0, 1, 2]], ..Default::default() };
        let mut body = Body::with_levels(context, &mesh, &[], 4);
        for turn in 0..12 {
            let angle = turn as f32;
            let rotation = Quat::from_euler(glam::EulerRot::XYZ, angle, 0.7 * angle, 0.3);
            body.pose = Pose { rotation, translation: Vec3::new(0.2, -0.1, 0.3) };
            let eye = Vec3::new(3.0 * angle.cos(), 1.0, 3.0 * angle.sin());
            let camera = Camera::look_at(eye, Vec3::ZERO, 0.5, [64, 64]);
            let depth = |p: &Vec3| -camera.view.transform_point3(body.pose.point(*p)).z;
            let least = mesh.positions.iter().map(depth).fold(f32::MAX, f32::min);
            assert!((body.nearest(&camera) - least).abs() < 1e-5, "{} and {least}", body.nearest(&camera));
            let inside =
                Camera::look_at(body.pose.point(Vec3::new(0.55, 0.35, 0.05)), Vec3::ZERO, 0.5, [64, 64]);
            assert_eq!(body.nearest(&inside), 0.0, "some of it lies behind an eye within");
        }
    }
}
