//! Geometry output for a host's scene: motion, depth and opacity of the visible hair.

use super::texels::Texels;
use crate::{
    draw::canvas::Canvas,
    gpu::{BindBuffer, Kernel, Uniform, commands::bytes},
    shaders::kernels::draw::tiles as kernels,
    space::Space,
};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, Mat4};

/// Format of the output: motion (pixels of the targets), depth, opacity.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Uniform of the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GeometryUniform {
    /// Maps normalized device coordinates of static points from this frame to the previous one.
    pub before: Mat4,
    /// `(a, b, c, d)`: the hair's depth `z` corresponds to the scene's depth `(a z + b) / (c z + d)`.
    pub depth: [f32; 4],
    /// 1 when the points of the previous frame are known and have the same numbers.
    pub is_known: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// State of the previous frame, for motion.
#[derive(Debug, PartialEq)]
struct LastFrame {
    /// Strand and vertex counts of each groom.
    parts: Vec<[u32; 2]>,
    camera: DMat4,
    /// Space that the frame was drawn in.
    space: Space,
}

/// The output texture and the state of the previous frame.
#[derive(Debug)]
pub(super) struct Geometry {
    pub texture: wgpu::TextureView,
    pub group: wgpu::BindGroup,
    uniform: Uniform,
    before: wgpu::Texture,
    last: Option<LastFrame>,
    /// Whether the last frame knew the points of the one before it.
    pub knows_motion: bool,
}

impl Geometry {
    /// Creates the output of the kernel for frames with `points`. It reads the tiles of `fine`.
    pub fn new(kernel: &Kernel, canvas: &Canvas<'_, '_>, points: &Texels, fine: kernels::Fine<'_>) -> Self {
        let device = &canvas.commands.context().device;
        use wgpu::TextureUsages as Usages;
        let usage = Usages::TEXTURE_BINDING | Usages::STORAGE_BINDING | Usages::COPY_SRC;
        let texture = canvas.target.texture()(("hair's geometry", FORMAT, usage));
        let texture = texture.create_view(&Default::default());
        let before = points.like(device, "points before");
        let uniform = device.storage_uniform(size_of::<GeometryUniform>());
        let view = before.create_view(&Default::default());
        let group = kernel.bind(&kernels::Geometry {
            fine,
            before: &view,
            geometry_of: uniform.entire(),
            known: &texture,
        });
        Self { texture, group, uniform, before, last: None, knows_motion: false }
    }

    /// Saves the previous frame's points before this frame overwrites them, and clears the output. `parts` are the
    /// strand and vertex counts of each groom; `depth` is as in [`GeometryUniform`].
    pub fn begin(
        &mut self,
        canvas: &mut Canvas<'_, '_>,
        points: &Texels,
        parts: Vec<[u32; 2]>,
        depth: [f32; 4],
    ) {
        points.keep(canvas.commands, &self.before);
        let camera = canvas.camera.projection.as_dmat4() * canvas.camera.view.as_dmat4();
        let is_known = self.last.as_ref().is_some_and(|last| last.parts == parts);
        // The previous camera is expressed in the current space, which may have moved.
        self.knows_motion = is_known;
        let last = self.last.replace(LastFrame { parts, camera, space: canvas.space });
        let last = last.map_or(camera, |last| last.camera * last.space.from(&canvas.space).matrix());
        let before = (last * camera.inverse()).as_mat4();
        let values = GeometryUniform { before, depth, is_known: is_known.into(), _pad: [0; 3] };
        self.uniform.write(0, bytemuck::bytes_of(&values));
        canvas.commands.clear_texture("no geometry", &self.texture);
    }

    /// Whether the last frame requested geometry.
    pub(crate) fn is_requested(&self) -> bool {
        self.last.is_some()
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        bytes(self.texture.texture()) + bytes(&self.before)
    }

    /// Forgets the previous frame, so that the next one has no motion.
    pub fn forget(&mut self) {
        self.last = None;
    }
}
