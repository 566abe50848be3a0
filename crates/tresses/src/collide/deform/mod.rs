//! Distance fields that deform with the skin of a body.
//!
//! A part of a body that bends is a distance field that goes with a joint, rigidly ([`crate::collide`]). Its skin does not:
//! near a neck two joints share it, cheeks and chests swell, a jaw opens. A field that deforms is asked at `p` where the
//! matter at `p` was at rest: `φ(p - u(p))`, with the way `u` that it has come, relative to its joint, on a coarse grid
//! around the field. The rest field stays; nothing of it is measured anew.
//!
//! ```text
//! vertices of the skin ─► gather ─────────────► settle ───────────► texture, two halves ─► nearest, contacts
//! poses of the parts   ─► per node: its nearest per node: where it                        (φ(p - u), velocity of the skin)
//!                         place of the skin     has come from
//! ```
//!
//! **Gather.** Each node belongs to the place of the skin that is nearest to it at rest, found once: a triangle of the part,
//! and shares of its corners. Its move is that place's, now, in the joint's frame, without the place at rest. No vertex
//! writes where others do: there are no atomics, and the same skin gives the same bits.
//!
//! **Settle.** Moves are known where they begin, but asked for where they end: three turns of `x = node - u(x)`.
//!
//! **Velocity.** The texture holds this frame's moves and those of the last frame that had steps. What touches skin feels
//! the difference, in as many parts as the frame has substeps, and sticks to it or slides on it as on anything that moves.
//! Positions are those at the end of the frame in all of its substeps.
//!
//! **Normals.** The gradient of `φ(p - u(p))` is `(1 - ∇u)ᵀ ∇φ`; `∇u` is asked by differences, of what is near the skin alone.
//! Without it skin that has turned by 20° pushes hair that lies on it backwards, and friction takes it along half as far.
//!
//! **Limits.** Skin goes at most [`MOST`] from where its joint would carry it. Distances are right to first order, at the
//! surface. Skin that folds within two nodes, the corners of a mouth, is smooth there. Volume and wind see the deformed
//! surface, but not that it moves.

use super::{
    FieldId, ShapeData,
    places::{JUMP, JUMP_ANGLE},
};
use crate::{
    Context, Error, Pose, Result,
    body::Skin,
    constants::{BUILD_WORKGROUP, DEFORM_NODES},
    gpu::{Binding, Kernel, PipelineSet},
    groom::{TriMesh, mesh::Bvh, rig::anatomy::Flesh},
    strands::buffers::filled,
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, UVec3, Vec3};
use std::sync::Arc;

/// The farthest that skin goes from where its part's joint would carry it, metres.
pub const MOST: f32 = 0.04;

/// Nodes of a part's grid.
const PART: u32 = DEFORM_NODES * DEFORM_NODES * DEFORM_NODES;

/// What the kernels know of a frame; the parts follow.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DeformHead {
    /// Nodes of all grids.
    pub count: u32,
    /// [`Words::first`] of the skin's positions.
    pub position_first: u32,
    /// [`Words::stride`] of them.
    pub position_stride: u32,
    /// The half of the texture that is this frame's.
    pub side: u32,
    /// 1 where the other half is to be the same: the skin has not moved here, it has jumped.
    pub fresh: u32,
    /// [`MOST`].
    pub most: f32,
    /// Unused.
    pub _pad: [u32; 2],
}

/// A field that deforms.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DeformPart {
    /// From the field's frame to the space of the skin's vertices, now.
    pub rotation: Quat,
    /// See `rotation`, metres.
    pub translation: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// The first node, the field's frame, metres.
    pub low: Vec3,
    /// Unused.
    pub _pad_b: u32,
    /// Nodes per metre.
    pub per_metre: Vec3,
    /// Unused.
    pub _pad_c: u32,
}

/// The place of the skin that is nearest to a node at rest.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DeformNode {
    /// Vertices of its triangle.
    pub triangle: [u32; 3],
    /// Share of the second corner.
    pub b: f32,
    /// Where it is at rest, the field's frame, metres.
    pub rest: Vec3,
    /// Share of the third corner.
    pub c: f32,
}

/// Which field of a [`ColliderSet`](super::ColliderSet) deforms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The head's.
    Head,
    /// One of [`ColliderDescriptor::fields`](super::ColliderDescriptor::fields).
    Field(FieldId),
}

/// A field whose body has skin that bends.
#[derive(Clone, Copy, Debug)]
pub struct DeformingField<'a> {
    /// Which field.
    pub which: Which,
    /// The triangles of the mesh whose skin is around it.
    pub triangles: &'a [[u32; 3]],
}

impl<'a> DeformingField<'a> {
    /// Those of a body that bends: of the [`Flesh`] of its head and its other solids those that deform, where the solids
    /// have the `fields` that are said.
    pub fn of(flesh: &'a Flesh, fields: impl Iterator<Item = Option<FieldId>>) -> Vec<Self> {
        let which = std::iter::once(Some(Which::Head)).chain(fields.map(|id| id.map(Which::Field)));
        let all = flesh.around().zip(which).filter(|(triangles, _)| !triangles.is_empty());
        all.filter_map(|(triangles, which)| Some(Self { which: which?, triangles })).collect()
    }
}

/// The pipelines.
#[derive(Debug)]
pub(crate) struct Pipelines {
    gather: Kernel,
    settle: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        use Binding::{Storage, StorageMut, Write3d};
        Self {
            gather: Kernel::new(
                &context.device,
                "collide::deform::gather",
                &[Storage, Storage, Storage, StorageMut],
            ),
            settle: Kernel::new(&context.device, "collide::deform::settle", &[Storage, Storage, Write3d]),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.gather, &self.settle]
    }
}

/// The texture of a set without fields that deform.
pub(super) fn none(device: &wgpu::Device) -> wgpu::Texture {
    texture(device, 1)
}

fn texture(device: &wgpu::Device, parts: u32) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("deformed fields"),
        size: wgpu::Extent3d {
            width: 2 * DEFORM_NODES,
            height: DEFORM_NODES,
            depth_or_array_layers: parts * DEFORM_NODES,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
        view_formats: &[],
    })
}

/// Bytes of the texture for so many parts.
fn texture_bytes(parts: u64) -> u64 {
    16 * u64::from(PART) * parts
}

/// A part before its grid is known.
pub(super) struct Grid<'a> {
    pub triangles: &'a [[u32; 3]],
    /// The first and the last node of its field, metres.
    pub box_: [Vec3; 2],
}

/// How the fields of one groom's colliders deform.
#[derive(Debug)]
pub struct Deformation {
    pipelines: Arc<Pipelines>,
    /// Where each part is: from the field's frame to the space of the skin's vertices. As many as were given, in the same
    /// order. Set them before each frame.
    pub poses: Vec<Pose>,
    head: DeformHead,
    parts: Vec<DeformPart>,
    buffer: wgpu::Buffer,
    gather: wgpu::BindGroup,
    settle: wgpu::BindGroup,
    pub(super) texture: wgpu::Texture,
    bytes: u64,
    fresh: bool,
    /// Whether this frame is one for which the skin is asked: hair between steps has none of it.
    due: bool,
}

/// The places of the skin that fields deform with, which instances of a body share.
#[derive(Clone, Debug)]
pub(crate) struct DeformPlaces {
    nodes: wgpu::Buffer,
    parts: Vec<DeformPart>,
    /// The number of the field of each part, the head's first.
    pub(super) fields: Vec<usize>,
}

impl DeformPlaces {
    /// Finds them on `mesh`, as it is at rest, for the fields of these numbers.
    pub(super) fn new(
        context: &Context,
        mesh: &TriMesh,
        grids: &[Grid<'_>],
        fields: Vec<usize>,
    ) -> Result<Self> {
        let most = context.device.limits().max_texture_dimension_3d;
        if grids.len() as u64 * u64::from(DEFORM_NODES) > u64::from(most) {
            return Err(Error::Colliders(format!(
                "{} fields cannot deform, but from one to {}",
                grids.len(),
                most / DEFORM_NODES
            )));
        }
        let (mut nodes, mut parts) = (Vec::with_capacity(grids.len() * PART as usize), Vec::new());
        for grid in grids {
            let [low, high] = grid.box_;
            let per_metre = (DEFORM_NODES - 1) as f32 / (high - low).max(Vec3::splat(1e-4));
            parts.push(DeformPart { rotation: Quat::IDENTITY, low, per_metre, ..Default::default() });
            nodes.extend(nearest(mesh, grid.triangles, low, per_metre)?);
        }
        let nodes = filled(context, "deforming nodes", bytemuck::cast_slice(&nodes))?;
        Ok(Self { nodes, parts, fields })
    }
}

impl Deformation {
    /// Fields that deform with `skin`.
    pub(super) fn new(context: &Context, places: &DeformPlaces, skin: &Skin<'_>) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let (buffer, words) = skin.positions;
        let DeformPlaces { nodes, parts, .. } = places;
        let head = DeformHead {
            count: parts.len() as u32 * PART,
            position_first: words.first,
            position_stride: words.stride,
            most: MOST,
            ..Default::default()
        };
        let known = [bytemuck::bytes_of(&head), bytemuck::cast_slice(parts)].concat();
        let frame = filled(context, "deforming parts", &known)?;
        let moves = crate::strands::buffers::storage::<[f32; 4]>(device, "moves of skin", head.count.into())?;
        let texture = texture(device, parts.len() as u32);
        let view = texture.create_view(&Default::default());
        let own = [&frame, nodes, buffer, &moves];
        let gather = pipelines.gather.bind(&own.map(|buffer| buffer.as_entire_binding()));
        let resources =
            [frame.as_entire_binding(), moves.as_entire_binding(), wgpu::BindingResource::TextureView(&view)];
        let settle = pipelines.settle.bind(&resources);
        let bytes = frame.size() + nodes.size() + moves.size() + texture_bytes(parts.len() as u64);
        Ok(Self {
            pipelines,
            poses: vec![Pose::IDENTITY; parts.len()],
            head,
            parts: parts.clone(),
            buffer: frame,
            gather,
            settle,
            texture,
            bytes,
            fresh: true,
            due: false,
        })
    }

    /// Tells a shape that its field is number `part` of those that deform: it is solid within [`MOST`] around what was.
    pub(super) fn widen(shape: &mut ShapeData, part: usize) {
        shape.deforms = part as u32 + 1;
        shape.size += MOST;
        shape.bound += MOST;
    }

    /// Writes what a frame's kernels read, and returns the half of the texture that is this frame's. `steps`: whether it
    /// has some; `jumps`: whether hair is put somewhere else.
    ///
    /// # Errors
    /// [`Error::Colliders`] for poses that are not as many as parts, or not finite.
    pub(super) fn prepare(&mut self, context: &Context, steps: bool, jumps: bool) -> Result<u32> {
        let Context { queue, .. } = context;
        if self.poses.len() != self.parts.len() {
            let (poses, parts) = (self.poses.len(), self.parts.len());
            return Err(Error::Colliders(format!("{poses} poses do not place {parts} fields that deform")));
        }
        for (part, pose) in self.parts.iter_mut().zip(&self.poses) {
            if !(pose.translation.is_finite() && pose.rotation.is_normalized()) {
                return Err(Error::Colliders("the pose of a field that deforms is not finite".into()));
            }
            // As colliders that jump push nothing on their way.
            let jump = part.rotation.angle_between(pose.rotation) > JUMP_ANGLE;
            self.fresh |= jump || part.translation.distance(pose.translation) > JUMP;
            (part.rotation, part.translation) = (pose.rotation, pose.translation);
        }
        if steps {
            self.head.side = 1 - self.head.side;
        }
        self.due = steps || self.fresh;
        self.head.fresh = (self.fresh || jumps).into();
        self.fresh = false;
        let known = [bytemuck::bytes_of(&self.head), bytemuck::cast_slice(&self.parts)].concat();
        queue.write_buffer(&self.buffer, 0, &known);
        Ok(self.head.side)
    }

    /// The half of the texture that is this frame's.
    pub(super) fn side(&self) -> u32 {
        self.head.side
    }

    /// Nobody has seen how the skin went on: the next frame has it where it is, without a speed.
    pub(crate) fn forget(&mut self) {
        self.fresh = true;
    }

    /// Records both kernels: after the skin has been bent, before the frame's first step.
    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        let groups = if self.due { self.head.count.div_ceil(BUILD_WORKGROUP) } else { 0 };
        self.pipelines.gather.record(pass, &self.gather, &[], groups);
        self.pipelines.settle.record(pass, &self.settle, &[], groups);
    }

    /// Bytes of GPU memory.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// For each node of a grid the place of the skin that is nearest to it.
fn nearest(mesh: &TriMesh, triangles: &[[u32; 3]], low: Vec3, per_metre: Vec3) -> Result<Vec<DeformNode>> {
    if triangles.is_empty() || triangles.iter().flatten().any(|i| *i as usize >= mesh.positions.len()) {
        return Err(Error::unusable("a field deforms with triangles of its skin's mesh"));
    }
    let part =
        TriMesh { positions: mesh.positions.clone(), triangles: triangles.to_vec(), ..TriMesh::default() };
    let bvh = Bvh::new(&part);
    let node = |i: u32| {
        let at =
            UVec3::new(i % DEFORM_NODES, i / DEFORM_NODES % DEFORM_NODES, i / (DEFORM_NODES * DEFORM_NODES));
        let closest = bvh.closest_point(low + at.as_vec3() / per_metre);
        let closest = closest.ok_or_else(|| Error::unusable("a field that deforms is at no finite place"))?;
        let triangle = triangles[closest.triangle as usize];
        let [a, b, c] = closest.barycentric.to_array();
        let [p, q, r] = triangle.map(|i| mesh.positions[i as usize]);
        Ok(DeformNode { triangle, b, rest: a * p + b * q + c * r, c })
    };
    (0..PART).map(node).collect()
}
