//! Meshes on the GPU, such as the head: simply shaded surfaces that receive light and reflect some of it onto hair.

pub(crate) mod paint;
mod skin;
mod surface;

pub(crate) use paint::BodyTextures;
pub use skin::{Skin, Words};
pub(crate) use surface::Surface;
pub(crate) use surface::points_for;

use bytemuck::{NoUninit, Pod, Zeroable};
use glam::{Mat4, Vec3};
use std::{
    ops::Range,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};
use wgpu::util::DeviceExt;

use crate::{
    Camera, Context, Pose, Result,
    gpu::{Binding, Uniform, bindings, readback},
    groom::{TriMesh, mesh::MeshLevel},
};

/// Material of a body: matte with soft gloss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMaterial {
    /// Albedo (linear) where the mesh has no vertex colors.
    pub color: Vec3,
    /// Strength of the gloss: 0 for chalk, 1 for skin or plastic.
    pub gloss: f32,
    /// Exponent of the gloss.
    pub gloss_exponent: f32,
    /// How far light wraps around the edge of the shadow: 0 for stone, 0.3 for skin.
    pub wrap: f32,
    /// Whether the body is a holdout: drawn with opacity 0, so that it only hides other objects.
    pub is_holdout: bool,
}

impl Default for BodyMaterial {
    /// A matte grayish beige for mannequins, more muted than any hair.
    fn default() -> Self {
        Self {
            color: Vec3::new(0.31, 0.27, 0.24),
            gloss: 0.25,
            gloss_exponent: 14.0,
            wrap: 0.2,
            is_holdout: false,
        }
    }
}

/// The parts of a mesh on the GPU that never change.
#[derive(Debug)]
struct BodyAsset {
    context: Context,
    triangles: wgpu::Buffer,
    /// Simplification error (meters) and index range of each level of detail, the full mesh first.
    levels: Vec<(f32, Range<u32>)>,
    surface: Surface,
}

/// A mesh on the GPU.
#[derive(Debug)]
pub struct Body {
    asset: Arc<BodyAsset>,
    /// Material.
    pub material: BodyMaterial,
    /// Pose in the world.
    pub pose: Pose,
    vertices: wgpu::Buffer,
    /// Two corners of the bounding box of the mesh, meters; see [`set_bounds`](Self::set_bounds).
    bounds: [Vec3; 2],
    /// Counts the shapes that the library has given the mesh.
    shape_count: u64,
    /// Whether code outside of the library has the vertex buffer.
    is_lent: AtomicBool,
    uniform: Uniform,
    group: wgpu::BindGroup,
    pub(crate) surface_group: wgpu::BindGroup,
    /// Material textures, if the body [is painted](Self::paint).
    painted: Option<BodyTextures>,
}

/// Identity, pose and shape of a body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodyState {
    group: wgpu::BindGroup,
    pose: Pose,
    shape_count: u64,
}

/// Uniform of a body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct BodyUniform {
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
    /// 0 for a [holdout](BodyMaterial::is_holdout), else 1.
    pub shown: f32,
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

    /// Uploads `mesh`, at the origin, and computes its [`levels`](TriMesh::levels) of detail. The body is drawn with
    /// the coarsest level whose error is invisible. Computing levels takes a quarter of a second for 100,000 triangles.
    /// To create several bodies from the same mesh, compute them once and use [`with_levels`](Self::with_levels).
    pub fn new(context: &Context, mesh: &TriMesh) -> Self {
        Self::with_levels(context, mesh, &mesh.levels(), u32::MAX)
    }

    /// As [`new`](Self::new), with given levels of detail, finest first. `cells` is the largest number of cells per
    /// edge of the views' grids of ambient light
    /// ([`ViewOptions::ambient_resolution`](crate::view::ViewOptions::ambient_resolution)): coarse grids need fewer
    /// points on the surface.
    pub fn with_levels(context: &Context, mesh: &TriMesh, levels: &[MeshLevel], cells: u32) -> Self {
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
        let vertices = buffer(
            "body vertices",
            bytemuck::cast_slice(&vertices),
            wgpu::BufferUsages::VERTEX
                | wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
        );
        let (mut triangles, mut ranges) = (Vec::new(), Vec::new());
        let own = (0.0, &mesh.triangles);
        for (stray, level) in std::iter::once(own).chain(levels.iter().map(|l| (l.stray, &l.triangles))) {
            let first = triangles.len() as u32;
            triangles.extend_from_slice(level.as_flattened());
            ranges.push((stray, first..triangles.len() as u32));
        }
        let asset = BodyAsset {
            context: context.clone(),
            triangles: buffer(
                "body triangles",
                bytemuck::cast_slice(&triangles),
                wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_SRC,
            ),
            levels: ranges,
            surface: Surface::new(device, mesh, cells),
        };
        let bounds = mesh.bounds().map_or([Vec3::ZERO; 2], |(lo, hi)| [lo, hi]);
        Self { bounds, ..Self::of(asset.into(), vertices) }
    }

    fn of(asset: Arc<BodyAsset>, vertices: wgpu::Buffer) -> Self {
        let device = &asset.context.device;
        let uniform = device.uniform(size_of::<BodyUniform>());
        let buffers = [
            uniform.as_entire_binding(),
            vertices.as_entire_binding(),
            asset.surface.buffer.as_entire_binding(),
        ];
        Self {
            material: BodyMaterial::default(),
            pose: Pose::IDENTITY,
            surface_group: device.group("surface", &surface_layout(device), &buffers),
            vertices,
            bounds: [Vec3::ZERO; 2],
            group: device.group("body", &layout(device), &[uniform.as_entire_binding()]),
            uniform,
            shape_count: 0,
            is_lent: AtomicBool::default(),
            painted: None,
            asset,
        }
    }

    /// Creates another body of the same mesh, at the same pose. If it `deforms`, it has its own copy of the vertices;
    /// otherwise it shares them, and deforming one body deforms both.
    pub fn instance(&self, deforms: bool) -> Self {
        let Context { device, queue, .. } = &self.asset.context;
        let mut vertices = self.vertices.clone();
        if deforms {
            vertices = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("body vertices"),
                size: self.vertices.size(),
                usage: self.vertices.usage(),
                mapped_at_creation: false,
            });
            let mut encoder = device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&self.vertices, 0, &vertices, 0, None);
            queue.submit([encoder.finish()]);
        }
        let (material, pose, bounds, painted) = (self.material, self.pose, self.bounds, self.painted.clone());
        let is_lent = AtomicBool::new(!deforms && self.is_lent.load(Ordering::Relaxed));
        Self { material, pose, bounds, painted, is_lent, ..Self::of(self.asset.clone(), vertices) }
    }

    /// Returns the points of the surface that receive light.
    pub(crate) fn surface(&self) -> &Surface {
        &self.asset.surface
    }

    /// Words of a vertex in [`vertices`](Self::vertices): position, normal, color.
    pub const WORDS: u32 = (size_of::<BodyVertex>() / 4) as u32;

    /// Vertex buffer with [`WORDS`](Self::WORDS) words per vertex: three floats of position (meters), three of normal,
    /// four bytes of color. Code that deforms the body writes to it.
    pub fn vertices(&self) -> &wgpu::Buffer {
        self.is_lent.store(true, Ordering::Relaxed);
        &self.vertices
    }

    /// Vertex buffer, for the library's own use.
    pub(crate) fn vertex_buffer(&self) -> &wgpu::Buffer {
        &self.vertices
    }

    /// Marks the mesh as deformed.
    pub(crate) fn mark_deformed(&mut self) {
        self.shape_count += 1;
    }

    /// Returns a value that is equal as long as mesh and pose are, or `None` if code outside of the library may deform
    /// the mesh at any time.
    pub(crate) fn state(&self) -> Option<BodyState> {
        let is_lent = self.is_lent.load(Ordering::Relaxed);
        let state =
            || BodyState { group: self.group.clone(), pose: self.pose, shape_count: self.shape_count };
        (!is_lent).then(state)
    }

    /// Reads back the full mesh in its deformed shape and pose: positions, normals and triangles, world space.
    ///
    /// # Errors
    /// Fails if the GPU is lost.
    pub async fn read(&self) -> Result<TriMesh> {
        let words: Vec<u32> = readback::buffer(&self.asset.context, &self.vertices).await?;
        let indices: Vec<u32> = readback::buffer(&self.asset.context, &self.asset.triangles).await?;
        let full = &self.asset.levels[0].1;
        let (vertices, _) = words.as_chunks::<{ Self::WORDS as usize }>();
        let vector = |words: &[u32]| Vec3::from_array([0, 1, 2].map(|k| f32::from_bits(words[k])));
        Ok(TriMesh {
            positions: vertices.iter().map(|words| self.pose.point(vector(words))).collect(),
            normals: vertices.iter().map(|words| self.pose.rotation * vector(&words[3..])).collect(),
            triangles: indices[full.start as usize..full.end as usize].as_chunks().0.to_vec(),
            ..TriMesh::default()
        })
    }

    /// Sets the bounding box of the vertices, in the body's own space, meters.
    pub fn set_bounds(&mut self, corners: [Vec3; 2]) {
        self.bounds = corners;
    }

    /// Uploads pose and material for the frame being recorded.
    pub(crate) fn prepare(&self) {
        let uniform = self.material.uniform(&self.pose, self.asset.surface.outward);
        self.uniform.write(0, bytemuck::bytes_of(&uniform));
    }

    /// Replaces positions, normals and colors of the vertices from `mesh`, for frames submitted from now on. The
    /// triangles of `mesh` are ignored, and so are its vertices beyond the body's last one. Levels of detail keep the
    /// errors of the original mesh. For a mesh that changes its shape or moves away, create the body without levels.
    pub fn move_to(&self, mesh: &TriMesh) {
        let vertices = vertices(mesh);
        let bytes: &[u8] = bytemuck::cast_slice(&vertices);
        let byte_count = self.vertices.size().min(bytes.len() as u64) as usize;
        self.asset.context.queue.write_buffer(&self.vertices, 0, &bytes[..byte_count]);
    }

    /// Smallest clip coordinate `w` of the body's points for `camera`: for a perspective camera, the distance of the
    /// nearest point, meters.
    pub(crate) fn nearest(&self, camera: &Camera) -> f32 {
        let w = (camera.projection * camera.view * self.pose.matrix()).row(3);
        // The nearest point of a box is the corner that faces the camera.
        let [lo, hi] = self.bounds;
        let corner = Vec3::select(w.truncate().cmplt(Vec3::ZERO), hi, lo);
        w.dot(corner.extend(1.0)).max(0.0)
    }

    /// Corners of the bounding box, world space.
    pub(crate) fn corners(&self) -> impl Iterator<Item = Vec3> {
        let [lo, hi] = self.bounds;
        (0..8).map(move |i| {
            let upper = glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0);
            self.pose.point(Vec3::select(upper, hi, lo))
        })
    }

    /// Whether the body is drawn with textures.
    pub(crate) fn is_painted(&self) -> bool {
        self.painted.is_some()
    }

    /// As [`record`](Self::record), with textures. Does nothing without them.
    pub(crate) fn record_painted(&self, pass: &mut crate::gpu::RenderPass<'_>, stray: f32) {
        if let Some(painted) = &self.painted {
            painted.bind(pass);
            self.record(pass, stray);
        }
    }

    /// Draws the coarsest level with an error of at most `stray` meters.
    pub(crate) fn record(&self, pass: &mut crate::gpu::RenderPass<'_>, stray: f32) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.asset.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(self.level(stray), 0, 0..1);
    }

    /// Index range of the coarsest level with an error of at most `stray`; the full mesh if there is none, as for
    /// negative `stray` or NaN.
    fn level(&self, stray: f32) -> Range<u32> {
        let level = self.asset.levels.iter().rev().find(|(strays, _)| *strays <= stray);
        level.unwrap_or(&self.asset.levels[0]).1.clone()
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.uniform.size() + self.shared_bytes()
    }

    /// Bytes of GPU memory that [instances](Self::instance) share.
    pub fn shared_bytes(&self) -> u64 {
        let painted = self.painted.as_ref().map_or(0, BodyTextures::bytes);
        self.vertices.size() + self.asset.triangles.size() + self.asset.surface.buffer.size() + painted
    }
}

/// Layout of a body's bind group, `@group(1)` where bodies are drawn.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    bindings::layout(device, "body", wgpu::ShaderStages::VERTEX_FRAGMENT, &[Binding::Uniform])
}

/// Layout of the bind group of a body's surface, `@group(1)` of kernels that evaluate its points.
pub(crate) fn surface_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entries = [Binding::Uniform, Binding::Storage, Binding::Storage];
    bindings::layout(device, "surface", wgpu::ShaderStages::COMPUTE, &entries)
}

/// Converts the vertices of a mesh to the layout of the GPU.
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
            shown: if self.is_holdout { 0.0 } else { 1.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn level_is_the_coarsest_within_the_error() {
        let context = &crate::gpu::noop();
        let mesh = TriMesh { triangles: vec![[0, 1, 2], [2, 1, 3]], ..Default::default() };
        let levels = [MeshLevel { stray: 1e-3, triangles: vec![[0, 1, 3]] }];
        let body = Body::with_levels(context, &mesh, &levels, 4);
        let drawn = [1.0, 1e-3, 5e-4, 0.0, -1.0, f32::NAN].map(|stray| body.level(stray));
        assert_eq!(drawn, [6..9, 6..9, 0..6, 0..6, 0..6, 0..6]);
    }

    #[test]
    fn nearest_is_the_depth_of_the_nearest_corner() {
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
