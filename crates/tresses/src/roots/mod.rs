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

pub use bind::RootReport;

use crate::{
    Context, Pose, Result,
    body::{Skin, Words},
    constants::{GUIDE_WORKGROUP, STRAND_WORKGROUP},
    gpu::{BindBuffer, Kernel, PipelineSet, Uniform},
    groom::TriMesh,
    math::map::Map,
    shaders::kernels::roots as kernels,
    strands::{
        GuideBuffers, StrandBuffers,
        buffers::{buffer, filled},
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
        let device = &context.device;
        Self {
            guides: Kernel::new::<kernels::Guides>(device),
            strands: Kernel::new::<kernels::Strands>(device),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.guides, &self.strands]
    }
}

/// Uniforms of a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct RootsUniform {
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

/// The roots of a groom, bound to points of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct RootAsset {
    /// [`GuideRoot`]s.
    guides: wgpu::Buffer,
    /// [`StrandRoot`]s; `None` if strands use the roots of their guides.
    strands: Option<wgpu::Buffer>,
    /// Distances of the roots from the mesh.
    pub report: RootReport,
}

impl RootAsset {
    /// Binds the roots of guides and strands to `mesh`, the surface at rest (groom space). No root may be farther from
    /// the surface than `max_distance` meters. `follows` if strands are their own guides.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for a root that is farther away and for a mesh without triangles;
    /// [`crate::Error::Limit`].
    pub fn new(
        context: &Context,
        roots: [&[Vec3]; 2],
        follows: bool,
        mesh: &TriMesh,
        max_distance: f32,
    ) -> Result<Self> {
        let (guides, strands, report) = bind::bind(roots, mesh, max_distance)?;
        let strands = (!follows).then(|| filled(context, "bound strands", bytemuck::cast_slice(&strands)));
        let guides = filled(context, "bound guides", bytemuck::cast_slice(&guides))?;
        Ok(Self { guides, strands: strands.transpose()?, report })
    }

    pub fn bytes(&self) -> u64 {
        self.guides.size() + self.strands.as_ref().map_or(0, wgpu::Buffer::size)
    }
}

/// Roots of one head on a surface.
#[derive(Debug)]
pub struct Roots {
    pipelines: Arc<Pipelines>,
    /// Pose of the surface: from the space of its vertices to the space of the frame's poses, by default the world. The
    /// caller sets it before each frame.
    pub pose: Pose,
    uniform: Uniform,
    guides: wgpu::BindGroup,
    strands: Option<wgpu::BindGroup>,
    pub(crate) asset: RootAsset,
    words: [Words; 2],
    fresh: bool,
}

impl Roots {
    /// Moves the roots with `skin`, the current vertices of the mesh that they are bound to.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(crate) fn new(
        context: &Context,
        asset: &RootAsset,
        (guides, strands): (&mut GuideBuffers, &mut StrandBuffers),
        skin: &Skin<'_>,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        // One element more than there are guides: kernels read the buffer only if it is longer than their number.
        guides.roots = buffer(device, "guide roots", u64::from(guides.count) + 1)?;
        let uniform = device.uniform(size_of::<RootsUniform>());
        let surface = kernels::Surface {
            u: uniform.entire(),
            positions: skin.positions.0.entire(),
            normals: skin.normals.0.entire(),
        };
        let guide_group = pipelines.guides.bind(&kernels::Guides {
            surface,
            bound: asset.guides.entire(),
            roots: guides.roots.entire(),
        });
        let mut strand_group = None;
        if let Some(bound) = &asset.strands {
            strands.roots = buffer(device, "strand roots", u64::from(strands.count) + 1)?;
            let (bound, roots) = (bound.entire(), strands.roots.entire());
            strand_group = Some(pipelines.strands.bind(&kernels::Strands { surface, bound, roots }));
        }
        Ok(Self {
            pipelines,
            pose: Pose::IDENTITY,
            uniform,
            guides: guide_group,
            strands: strand_group,
            asset: asset.clone(),
            words: [skin.positions.1, skin.normals.1],
            fresh: true,
        })
    }

    /// Writes the uniforms of a frame with the head at `head`; `to_drawn_space` maps to the space in which hair is
    /// drawn. With `fresh`, and in the first frame, hair starts at the current skin without any previous motion.
    pub(crate) fn prepare(&mut self, (head, to_drawn_space): (&Pose, &Map), counts: [u32; 2], fresh: bool) {
        let to_head = head.inverse().after(&self.pose);
        let to_world = to_drawn_space.pose(&self.pose);
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
        self.uniform.write(0, bytemuck::bytes_of(&uniform));
    }

    /// Records the stage.
    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, counts: [u32; 2]) {
        self.pipelines.guides.record(pass, &self.guides, &[], counts[0].div_ceil(GUIDE_WORKGROUP));
        if let Some(strands) = &self.strands {
            self.pipelines.strands.record(pass, strands, &[], counts[1].div_ceil(STRAND_WORKGROUP));
        }
    }

    /// Bytes of GPU memory of this head alone, without the buffers of guides and strands.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.uniform.size()
    }
}
