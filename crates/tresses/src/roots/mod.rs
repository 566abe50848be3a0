//! Roots on deforming skin.
//!
//! A root is bound to a point on a triangle of a body. The body's current vertices come from a [skinned
//! body](crate::skinning), or from a buffer that an engine fills ([`Skin`]). Nothing is read back.
//!
//! ```text
//! vertices of the body ─┬─► guides  ─► RootMotion of each guide ─► simulate, tessellate (or interpolate::follow)
//! poses of body, head  ─┴─► strands ─► where each strand begins ─► interpolate::blend
//! ```
//!
//! **Rigid head.** [`HairFrame::head`](crate::hair::HairFrame::head) is the pose of the rigid part that most hair
//! follows, such as the head joint. Colliders, grids and the clock use only this pose. A root's motion is relative to
//! it: the identity where skin moves with the joint. Without a surface this stage does not run, and the motion of hair
//! is bit-identical.
//!
//! **Rotation.** The frame of a skin point follows the smooth normal there and the triangle's first edge. The
//! triangle's own normal would rotate neighboring roots by the angle between two triangles.
//!
//! **Between frames.** The skin is known once per frame. Steps that end in between use a fraction of its motion, from
//! the end of the previous step to the current state, as for the head (`clock`).
//!
//! **Between guides.** A strand that follows up to three guides begins at its own root, not between theirs, and
//! continues in the direction that the guides determine. Brows thus stay on a forehead that moves between guides.
//! Strands that are their own guides need only the guides' roots.
//!
//! **Fields.** The distance field of a head belongs to the rigid part, unless it deforms with the same skin
//! ([`crate::collide::deform`]). Roots that the skin carries into the field stay inside it: contacts push no vertex
//! farther out than its rest distance.

mod bind;

pub use bind::{GuideRoot, RootReport, StrandRoot};

use crate::{
    Context, Pose, Result,
    body::{Skin, Words},
    constants::{GUIDE_WORKGROUP, STRAND_WORKGROUP},
    gpu::{Binding, Kernel, PipelineSet, bindings},
    groom::{BoundStrands, Groom, TriMesh},
    math::map::Map,
    strands::{
        GuideBuffers, RootMotion, StrandBuffers,
        buffers::{filled, storage},
    },
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// The pipelines of the stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    guides: Kernel,
    strands: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        use Binding::{Storage, StorageMut, Uniform};
        let entries = [Uniform, Storage, Storage, Storage, StorageMut];
        let kernel = |name| Kernel::new(&context.device, name, &entries);
        Self { guides: kernel("roots::guides"), strands: kernel("roots::strands") }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.guides, &self.strands]
    }
}

/// Uniforms of a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RootsUniform {
    /// Rotation from the surface's space to the space in which hair is drawn.
    pub to_world_rotation: Quat,
    /// Rotation from the surface's space to the head's.
    pub to_head_rotation: Quat,
    /// Translation from the surface's space to the space in which hair is drawn, meters.
    pub to_world: Vec3,
    /// [`Words::first`] of the positions.
    pub position_first: u32,
    /// Translation from the surface's space to the head's, meters.
    pub to_head: Vec3,
    /// [`Words::stride`] of the positions.
    pub position_stride: u32,
    /// [`Words::first`] of the normals.
    pub normal_first: u32,
    /// [`Words::stride`] of the normals.
    pub normal_stride: u32,
    /// Number of guides.
    pub guide_count: u32,
    /// Number of strands with bound roots.
    pub strand_count: u32,
    /// 1 if the state of the previous frame is unknown.
    pub fresh: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// Roots of one groom on a surface.
#[derive(Debug)]
pub struct Roots {
    pipelines: Arc<Pipelines>,
    /// Pose of the surface: from the space of its vertices to the space of the frame's poses, by default the world. The
    /// caller sets it before each frame.
    pub pose: Pose,
    uniform: wgpu::Buffer,
    guides: wgpu::BindGroup,
    strands: Option<wgpu::BindGroup>,
    /// Skin points of guides and strands, shared by instances.
    bound: (wgpu::Buffer, Option<wgpu::Buffer>),
    words: [Words; 2],
    fresh: bool,
}

impl Roots {
    /// Binds the roots of `groom` to `mesh`, the surface at rest (groom space); `skin` has its vertices in each frame.
    /// `arranged` are the groom's strands in drawing order. No root may be farther from the surface than `reach`
    /// meters.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for a root that is farther away, for a mesh without triangles, and for buffers
    /// that are too short for the mesh; [`crate::Error::Limit`].
    pub(crate) fn new(
        context: &Context,
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
        let of_guides = filled(context, "bound guides", bytemuck::cast_slice(&bound_guides))?;
        // Strands that are their own guides use the guides' roots.
        let of_strands = (guides.sample_count > 0)
            .then(|| filled(context, "bound strands", bytemuck::cast_slice(&bound_strands)))
            .transpose()?;
        Ok((Self::bound(context, (of_guides, of_strands), (guides, strands), skin)?, report))
    }

    /// Creates the same roots on another body with the same mesh, for other guides and strands of the same groom.
    pub(crate) fn instance(
        &self,
        context: &Context,
        buffers: (&mut GuideBuffers, &mut StrandBuffers),
        skin: &Skin<'_>,
    ) -> Result<Self> {
        Self::bound(context, self.bound.clone(), buffers, skin)
    }

    /// Creates the roots for skin points on a mesh.
    fn bound(
        context: &Context,
        bound: (wgpu::Buffer, Option<wgpu::Buffer>),
        (guides, strands): (&mut GuideBuffers, &mut StrandBuffers),
        skin: &Skin<'_>,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        // One element more than there are guides: kernels read the buffer only if it is longer than their number.
        guides.roots = storage::<RootMotion>(device, "guide roots", u64::from(guides.count) + 1)?;
        let uniform = bindings::uniform(device, "roots", size_of::<RootsUniform>());
        let group = |kernel: &Kernel, bound: &wgpu::Buffer, out: &wgpu::Buffer| {
            let buffers = [&uniform, skin.positions.0, skin.normals.0, bound, out];
            kernel.bind(&buffers.map(|buffer| buffer.as_entire_binding()))
        };
        let (of_guides, of_strands) = &bound;
        let guide_group = group(&pipelines.guides, of_guides, &guides.roots);
        let mut strand_group = None;
        if let Some(of_strands) = of_strands {
            strands.roots = storage::<[f32; 4]>(device, "strand roots", u64::from(strands.count) + 1)?;
            strand_group = Some(group(&pipelines.strands, of_strands, &strands.roots));
        }
        Ok(Self {
            pipelines,
            pose: Pose::IDENTITY,
            uniform,
            guides: guide_group,
            strands: strand_group,
            bound,
            words: [skin.positions.1, skin.normals.1],
            fresh: true,
        })
    }

    /// Writes the uniforms of a frame with the head at `head`; `seen` maps to the space in which hair is drawn. With
    /// `fresh`, and in the first frame, hair starts at the current skin without any previous motion.
    pub(crate) fn prepare(
        &mut self,
        context: &Context,
        (head, seen): (&Pose, &Map),
        counts: [u32; 2],
        fresh: bool,
    ) {
        let Context { queue, .. } = context;
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
    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, counts: [u32; 2]) {
        self.pipelines.guides.record(pass, &self.guides, &[], counts[0].div_ceil(GUIDE_WORKGROUP));
        if let Some(strands) = &self.strands {
            self.pipelines.strands.record(pass, strands, &[], counts[1].div_ceil(STRAND_WORKGROUP));
        }
    }

    /// Bytes of GPU memory, without the buffers of guides and strands.
    pub fn bytes(&self) -> u64 {
        let (guides, strands) = &self.bound;
        self.uniform.size() + guides.size() + strands.as_ref().map_or(0, wgpu::Buffer::size)
    }
}
