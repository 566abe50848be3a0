//! Roots on a living surface: hair goes with skin that bends.
//!
//! A root belongs to a place on a triangle of a body. Where the body's vertices are, somebody else says: a [skinned
//! body](crate::skinning), or a buffer that an engine fills ([`Skin`]). Nothing is read back.
//!
//! ```text
//! vertices of the body ─┬─► guides  ─► RootMotion of each guide ─► simulate, tessellate (or interpolate::follow)
//! poses of body, head  ─┴─► strands ─► where each strand begins ─► interpolate::blend
//! ```
//!
//! **The head remains.** [`Frame::head`](crate::frame::Frame::head) is the pose of the rigid part that hair mostly goes
//! with, such as the joint of a head; colliders, grids and the clock know it alone. A root's motion is what the skin adds
//! to that: the identity where skin goes with the joint. Without a surface nothing of this is computed, and hair moves to
//! the bit as it did.
//!
//! **Turns.** A place is turned as the smooth normal there and its triangle's first edge are. The triangle's own normal
//! would turn neighbouring roots by the angle between two triangles.
//!
//! **Between frames.** Skin is known once per frame. Steps that end in between have its motion in parts, from where the
//! step before ended to where it is now, as the head's is (`clock`).
//!
//! **Between guides.** A strand that follows up to three guides begins where its own root is, not between where theirs
//! are, and goes on in the direction that they give it: brows stay on a forehead that moves between guides. Strands that
//! are their own guides need no more than those.
//!
//! **Fields.** The distance field of a head is that of the rigid part, unless it deforms with the same skin
//! ([`crate::collide::deform`]). Roots that the skin carries into it are in it (contacts keep no vertex farther away than
//! it rests).

mod bind;

pub use bind::{GuideRoot, RootReport, StrandRoot};

use crate::{
    Error, Pose, Result,
    body::Body,
    constants::{GUIDE_WORKGROUP, STRAND_WORKGROUP},
    gpu::{Binding, Kernel, bindings},
    groom::{BoundStrands, Groom, TriMesh},
    space::Map,
    strands::{
        GuideBuffers, RootMotion, StrandBuffers,
        buffers::{filled, storage},
    },
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// Where a surface's vertices are in a buffer of floats: words from its beginning, and from one vertex to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Words {
    /// Of the first vertex.
    pub first: u32,
    /// From one vertex to the next, at least 3.
    pub stride: u32,
}

impl Words {
    /// # Errors
    /// [`crate::groom::Error::Unusable`] where `buffer` does not hold the vertices of `mesh` so.
    pub(crate) fn hold(&self, buffer: &wgpu::Buffer, mesh: &TriMesh) -> Result<()> {
        let last = (mesh.positions.len() as u64).saturating_sub(1);
        let need = 4 * (u64::from(self.first) + last * u64::from(self.stride) + 3);
        if self.stride < 3 || buffer.size() < need {
            return Err(Error::unusable(format!(
                "a buffer of {} bytes is too small for the skin's {} vertices",
                buffer.size(),
                mesh.positions.len()
            )));
        }
        Ok(())
    }
}

/// The vertices of a body that bends, in buffers that may be bound as storage. The same buffer may be both.
#[derive(Clone, Copy, Debug)]
pub struct Skin<'a> {
    /// Three floats for each vertex, metres.
    pub positions: (&'a wgpu::Buffer, Words),
    /// Three floats for each vertex, of any length.
    pub normals: (&'a wgpu::Buffer, Words),
}

impl<'a> From<&'a Body> for Skin<'a> {
    fn from(body: &'a Body) -> Self {
        let [position, normal] = [0, 3].map(|first| (body.vertices(), Words { first, stride: Body::WORDS }));
        Self { positions: position, normals: normal }
    }
}

/// The pipelines of the stage.
#[derive(Debug)]
pub struct Pipelines {
    guides: Kernel,
    strands: Kernel,
}

impl Pipelines {
    /// None compiled yet.
    pub fn new(device: &wgpu::Device) -> Self {
        use Binding::{Storage, StorageMut, Uniform};
        let entries = [Uniform, Storage, Storage, Storage, StorageMut];
        let kernel = |name| Kernel::new(device, name, &entries);
        Self { guides: kernel("roots::guides"), strands: kernel("roots::strands") }
    }

    /// All of them.
    pub(crate) fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.guides, &self.strands]
    }
}

/// What the kernels know of a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RootsUniform {
    /// From the surface's space to where hair is drawn.
    pub to_world_rotation: Quat,
    /// From the surface's space to the head's.
    pub to_head_rotation: Quat,
    /// See `to_world_rotation`, metres.
    pub to_world: Vec3,
    /// [`Words::first`] of the positions.
    pub position_first: u32,
    /// See `to_head_rotation`, metres.
    pub to_head: Vec3,
    /// [`Words::stride`] of the positions.
    pub position_stride: u32,
    /// [`Words::first`] of the normals.
    pub normal_first: u32,
    /// [`Words::stride`] of the normals.
    pub normal_stride: u32,
    /// Number of guides.
    pub guide_count: u32,
    /// Number of strands whose roots are asked for.
    pub strand_count: u32,
    /// 1 where nothing is known of the frame before.
    pub fresh: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// One groom's share of the stage.
#[derive(Debug)]
pub struct Roots {
    /// Where the surface is: from the space of its vertices to that of the frame's poses, by default the world. Set it
    /// before each frame.
    pub pose: Pose,
    uniform: wgpu::Buffer,
    guides: wgpu::BindGroup,
    strands: Option<wgpu::BindGroup>,
    words: [Words; 2],
    bytes: u64,
    fresh: bool,
}

impl Roots {
    /// The roots of `groom`, whose strands are `arranged` as they are drawn, on `mesh` as it is at rest (groom space)
    /// and as `skin` has it in each frame. None may be farther from it than `reach` metres.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for a root that is farther away, for a mesh without triangles and for buffers
    /// that are too short for it; [`Error::Limit`].
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        stage: &Pipelines,
        (groom, arranged): (&Groom, &BoundStrands),
        (guides, strands): (&mut GuideBuffers, &mut StrandBuffers),
        mesh: &TriMesh,
        skin: &Skin<'_>,
        reach: f32,
    ) -> Result<(Self, RootReport)> {
        for (buffer, words) in [skin.positions, skin.normals] {
            words.hold(buffer, mesh)?;
        }
        let (bound_guides, bound_strands, report) = bind::bind(groom, arranged, mesh, reach)?;
        // More than one to each: that tells kernels that they are to be read.
        guides.roots = storage::<RootMotion>(device, "guide roots", u64::from(guides.count) + 1)?;
        let uniform = bindings::uniform(device, "roots", size_of::<RootsUniform>());
        let upload = |what, bytes: &[u8]| filled(device, queue, what, bytes);
        let group = |kernel: &Kernel, bound: &wgpu::Buffer, out: &wgpu::Buffer| {
            let buffers = [&uniform, skin.positions.0, skin.normals.0, bound, out];
            kernel.bind(device, &buffers.map(|buffer| buffer.as_entire_binding()))
        };
        let of_guides = upload("bound guides", bytemuck::cast_slice(&bound_guides))?;
        let mut bytes = of_guides.size() + uniform.size();
        let guide_group = group(&stage.guides, &of_guides, &guides.roots);
        // Strands that are guides themselves begin where those do.
        let mut strand_group = None;
        if guides.sample_count > 0 {
            strands.roots = storage::<[f32; 4]>(device, "strand roots", u64::from(strands.count) + 1)?;
            let of_strands = upload("bound strands", bytemuck::cast_slice(&bound_strands))?;
            bytes += of_strands.size();
            strand_group = Some(group(&stage.strands, &of_strands, &strands.roots));
        }
        let words = [skin.positions.1, skin.normals.1];
        let roots = Self {
            pose: Pose::IDENTITY,
            uniform,
            guides: guide_group,
            strands: strand_group,
            words,
            bytes,
            fresh: true,
        };
        Ok((roots, report))
    }

    /// Writes what a frame's kernels read: the head is at `head`, and hair is drawn where `seen` leads. With `fresh`, or
    /// the first time, hair is where the skin is now, whatever was before.
    pub(crate) fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        (head, seen): (&Pose, &Map),
        counts: [u32; 2],
        fresh: bool,
    ) {
        let to_head = head.inverse().after(&self.pose);
        let to_world = seen.pose(&self.pose);
        let [position, normal] = self.words;
        let uniform = RootsUniform {
            to_world_rotation: to_world.rotation,
            to_head_rotation: to_head.rotation,
            to_world: to_world.translation,
            position_first: position.first,
            to_head: to_head.translation,
            position_stride: position.stride,
            normal_first: normal.first,
            normal_stride: normal.stride,
            guide_count: counts[0],
            strand_count: counts[1],
            fresh: (self.fresh || fresh).into(),
            ..Default::default()
        };
        self.fresh = false;
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// Records the stage.
    pub(crate) fn record(&self, stage: &Pipelines, pass: &mut crate::gpu::ComputePass<'_>, counts: [u32; 2]) {
        stage.guides.record(pass, &self.guides, &[], counts[0].div_ceil(GUIDE_WORKGROUP));
        if let Some(strands) = &self.strands {
            stage.strands.record(pass, strands, &[], counts[1].div_ceil(STRAND_WORKGROUP));
        }
    }

    /// Bytes of GPU memory, without what guides and strands have of it.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}
