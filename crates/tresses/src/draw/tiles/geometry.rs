//! What else than its colour a host's scene may ask of hair: where it was, how far away it is, how opaque.

use super::texels::Texels;
use crate::{
    draw::record::Canvas,
    gpu::{Kernel, bindings::uniform, commands::bytes},
    space::Space,
};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, Mat4};

/// Motion (pixels of the targets), depth, opacity.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// What the kernel knows.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GeometryUniform {
    /// From normalised coordinates of this picture to those of the one before, for what stands still.
    pub before: Mat4,
    /// `(a, b, c, d)`: a depth `z` of the hair is `(a z + b) / (c z + d)` of the scene.
    pub depth: [f32; 4],
    /// 1 when the points of the picture before are known, each under its number.
    pub is_known: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// What a picture is compared with to tell what moved.
#[derive(Debug, PartialEq)]
struct Last {
    /// Strands and vertices of each groom.
    parts: Vec<[u32; 2]>,
    camera: DMat4,
    /// The space that it was drawn in.
    space: Space,
}

/// The texture, and what is kept of the picture before.
#[derive(Debug)]
pub(super) struct Geometry {
    pub texture: wgpu::TextureView,
    pub group: wgpu::BindGroup,
    uniform: wgpu::Buffer,
    before: wgpu::Texture,
    last: Option<Last>,
    /// Whether the points of the picture before were known in the last one.
    pub knows_motion: bool,
}

impl Geometry {
    /// For pictures of `points`; the kernel's resources are `of_rows`, then those of its own around `round`.
    pub fn new(
        kernel: &Kernel,
        canvas: &Canvas<'_, '_>,
        points: &Texels,
        of_rows: &[wgpu::BindingResource<'_>],
        round: wgpu::BindingResource<'_>,
    ) -> Self {
        let device = &canvas.commands.context().device;
        use wgpu::TextureUsages as Usages;
        let usage = Usages::TEXTURE_BINDING | Usages::STORAGE_BINDING | Usages::COPY_SRC;
        let texture = canvas.targets.texture()(("hair's geometry", FORMAT, usage));
        let texture = texture.create_view(&Default::default());
        let before = points.like(device, "points before");
        let uniform = uniform(device, "geometry of hair", size_of::<GeometryUniform>());
        let view = before.create_view(&Default::default());
        let own = [
            wgpu::BindingResource::TextureView(&view),
            round,
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&texture),
        ];
        let group = kernel.bind(&of_rows.iter().cloned().chain(own).collect::<Vec<_>>());
        Self { texture, group, uniform, before, last: None, knows_motion: false }
    }

    /// Keeps the points of the picture before, which those of this one are about to replace, and clears the texture.
    /// `parts` are the strands and vertices of each groom; `depth` is as in [`GeometryUniform`].
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
        // What stands still in the world stands elsewhere before a camera whose space has moved.
        self.knows_motion = is_known;
        let last = self.last.replace(Last { parts, camera, space: canvas.space });
        let last = last.map_or(camera, |last| last.camera * last.space.from(&canvas.space).matrix());
        let before = (last * camera.inverse()).as_mat4();
        let values = GeometryUniform { before, depth, is_known: is_known.into(), _pad: [0; 3] };
        canvas.commands.context().queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&values));
        canvas.commands.clear_texture("no geometry", &self.texture);
    }

    /// Whether the last picture asked.
    pub fn is_asked(&self) -> bool {
        self.last.is_some()
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        bytes(self.texture.texture()) + bytes(&self.before)
    }

    /// The next picture has none before it.
    pub fn forget(&mut self) {
        self.last = None;
    }
}
