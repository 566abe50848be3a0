//! Distance fields that deform with skin.
//!
//! A part of a skinned body is a distance field that moves rigidly with a joint ([`crate::collide`]). Its skin deforms:
//! near the neck two joints share it, cheeks and chests swell, a jaw opens. A deforming field is sampled at the rest
//! position of the matter at `p`, as `φ(p - u(p))`. A coarse grid around the field holds the displacement `u` relative
//! to the joint. The rest field stays valid and is not rebuilt.
//!
//! ```text
//! vertices of the skin ─► gather ───────────► settle ───────────► texture, two halves ─► nearest, contacts
//! poses of the parts   ─► per node: nearest   per node: where it                        (φ(p - u), skin velocity)
//!                         point of the skin   has come from
//! ```
//!
//! **Gather.** Each node is bound to the nearest point of the skin at rest, found once: a triangle of the part, and
//! barycentric coordinates. The node's displacement is the current position of that point in the joint's frame, minus
//! its rest position. Each thread writes only its own node, so there are no atomics and results are bit-identical for
//! the same skin.
//!
//! **Settle.** Displacements are known at their start, but sampled at their end: three iterations of `x = node - u(x)`.
//!
//! **Velocity.** The texture holds the displacements of this frame and of the last frame with steps. Hair in contact
//! with skin is exposed to the difference, divided by the frame's substeps, and sticks to the skin or slides on it as
//! on any moving collider. In all substeps, positions are those at the end of the frame.
//!
//! **Normals.** The gradient of `φ(p - u(p))` is `(1 - ∇u)ᵀ ∇φ`; `∇u` is computed by finite differences, only near the
//! skin. Without it, skin that has turned by 20° pushes the hair on it backwards, and friction carries it only half as
//! far.
//!
//! **Limits.** Skin moves at most [`MAX_DISPLACEMENT`] from its rigid position on the joint. Distances are correct to
//! first order at the surface. Skin that folds within two nodes, such as the corners of a mouth, is smoothed. Volume
//! and wind use the deformed surface, but not its velocity.

use super::{
    FieldId, ShapeData,
    poses::{JUMP, JUMP_ANGLE},
};
use crate::{
    Context, Error, Pose, Result,
    body::Skin,
    constants::{BUILD_WORKGROUP, DEFORM_NODES},
    gpu::{BindBuffer, Device, Kernel, PipelineSet, Uniform},
    groom::{TriMesh, mesh::Bvh, rig::anatomy::Flesh},
    shaders::kernels::collide::deform as kernels,
    strands::buffers::filled,
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, UVec3, Vec3};
use std::sync::Arc;

/// Largest displacement of skin from its rigid position on the part's joint, meters.
pub const MAX_DISPLACEMENT: f32 = 0.04;

/// Nodes in the grid of a part.
const PART: u32 = DEFORM_NODES * DEFORM_NODES * DEFORM_NODES;

/// Uniforms of a frame; the parts follow in the same buffer.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct DeformHead {
    /// Number of nodes in all grids.
    pub count: u32,
    /// `Words::first` of the skin's positions.
    pub position_first: u32,
    /// `Words::stride` of the skin's positions.
    pub position_stride: u32,
    /// Half of the texture that belongs to this frame.
    pub side: u32,
    /// 1 to write the same displacements to the other half: the skin has jumped and has no velocity.
    pub fresh: u32,
    /// [`MAX_DISPLACEMENT`].
    pub max_displacement: f32,
    /// Unused.
    pub _pad: [u32; 2],
}

/// A deforming field.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct DeformPart {
    /// Rotation from the field's frame to the current space of the skin's vertices.
    pub rotation: Quat,
    /// Translation of the same transform, meters.
    pub translation: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// Position of the first node in the field's frame, meters.
    pub low: Vec3,
    /// Unused.
    pub _pad_b: u32,
    /// Nodes per meter.
    pub per_meter: Vec3,
    /// Unused.
    pub _pad_c: u32,
}

/// The skin point nearest to a node at rest.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct DeformNode {
    /// Vertices of the point's triangle.
    pub triangle: [u32; 3],
    /// Barycentric coordinate of the second corner.
    pub b: f32,
    /// Rest position of the point in the field's frame, meters.
    pub rest: Vec3,
    /// Barycentric coordinate of the third corner.
    pub c: f32,
}

/// Selects the field of a `ColliderSet` that deforms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeformTarget {
    /// The head's field.
    Head,
    /// One of [`ColliderDescriptor::fields`](super::ColliderDescriptor::fields).
    Field(FieldId),
}

/// A field surrounded by deforming skin.
#[derive(Clone, Copy, Debug)]
pub struct DeformingField<'a> {
    /// The field.
    pub which: DeformTarget,
    /// The triangles of the skin mesh around the field.
    pub triangles: &'a [[u32; 3]],
}

impl<'a> DeformingField<'a> {
    /// Returns the deforming fields of a skinned body: its head and those other solids that have a field in `fields`,
    /// as far as their [`Flesh`] deforms.
    pub fn of(flesh: &'a Flesh, fields: impl Iterator<Item = Option<FieldId>>) -> Vec<Self> {
        let which =
            std::iter::once(Some(DeformTarget::Head)).chain(fields.map(|id| id.map(DeformTarget::Field)));
        let all = flesh.around().zip(which).filter(|(triangles, _)| !triangles.is_empty());
        all.filter_map(|(triangles, which)| Some(Self { which: which?, triangles })).collect()
    }
}

/// The pipelines of field deformation.
#[derive(Debug)]
pub(crate) struct Pipelines {
    gather: Kernel,
    settle: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let device = &context.device;
        Self {
            gather: Kernel::new::<kernels::Gather>(device),
            settle: Kernel::new::<kernels::Settle>(device),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.gather, &self.settle]
    }
}

/// Returns a placeholder texture for a set without deforming fields.
pub(super) fn none(device: &Device) -> wgpu::Texture {
    texture(device, 1)
}

fn texture(device: &Device, parts: u32) -> wgpu::Texture {
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

/// Returns the bytes of the texture for `parts` parts.
fn texture_bytes(parts: u64) -> u64 {
    16 * u64::from(PART) * parts
}

/// Input of the grid of a part.
pub(super) struct Grid<'a> {
    pub triangles: &'a [[u32; 3]],
    /// Positions of the first and last node of its field, meters.
    pub box_: [Vec3; 2],
}

/// Deformation of the fields of one groom's colliders.
#[derive(Debug)]
pub struct Deformation {
    pipelines: Arc<Pipelines>,
    /// Pose of each part, from the field's frame to the space of the skin's vertices, in the order in which the fields
    /// were given. The caller sets them before each frame.
    pub poses: Vec<Pose>,
    head: DeformHead,
    parts: Vec<DeformPart>,
    buffer: Uniform,
    gather: wgpu::BindGroup,
    settle: wgpu::BindGroup,
    pub(super) texture: wgpu::Texture,
    bytes: u64,
    fresh: bool,
    /// Whether the kernels run in this frame. Frames without steps skip them.
    due: bool,
}

/// Skin points with which fields deform, shared by instances of a body.
#[derive(Clone, Debug)]
pub(crate) struct DeformPoints {
    nodes: wgpu::Buffer,
    parts: Vec<DeformPart>,
    /// Index of the field of each part, the head's first.
    pub(super) fields: Vec<usize>,
}

impl DeformPoints {
    /// Finds the skin points on `mesh`, at rest, for the fields with the indices `fields`.
    pub(super) fn new(
        context: &Context,
        mesh: &TriMesh,
        grids: &[Grid<'_>],
        fields: Vec<usize>,
    ) -> Result<Self> {
        let max_size = context.device.limits().max_texture_dimension_3d;
        if grids.len() as u64 * u64::from(DEFORM_NODES) > u64::from(max_size) {
            return Err(Error::Colliders(format!(
                "{} fields cannot deform; this adapter allows {}",
                grids.len(),
                max_size / DEFORM_NODES
            )));
        }
        let (mut nodes, mut parts) = (Vec::with_capacity(grids.len() * PART as usize), Vec::new());
        for grid in grids {
            let [low, high] = grid.box_;
            let per_meter = (DEFORM_NODES - 1) as f32 / (high - low).max(Vec3::splat(1e-4));
            parts.push(DeformPart { rotation: Quat::IDENTITY, low, per_meter, ..Default::default() });
            nodes.extend(nearest(mesh, grid.triangles, low, per_meter)?);
        }
        let nodes = filled(context, "deforming nodes", bytemuck::cast_slice(&nodes))?;
        Ok(Self { nodes, parts, fields })
    }
}

impl Deformation {
    /// Creates the deformation of fields with `skin`.
    pub(super) fn new(context: &Context, points: &DeformPoints, skin: &Skin<'_>) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let (buffer, words) = skin.positions;
        let DeformPoints { nodes, parts, .. } = points;
        let head = DeformHead {
            count: parts.len() as u32 * PART,
            position_first: words.first,
            position_stride: words.stride,
            max_displacement: MAX_DISPLACEMENT,
            ..Default::default()
        };
        let known = [bytemuck::bytes_of(&head), bytemuck::cast_slice(parts)].concat();
        let frame = device.storage_uniform(known.len());
        frame.write(0, &known);
        let moves = crate::strands::buffers::storage::<[f32; 4]>(device, "moves of skin", head.count.into())?;
        let texture = texture(device, parts.len() as u32);
        let view = texture.create_view(&Default::default());
        let gather = kernels::Gather {
            u: frame.entire(),
            nodes: nodes.entire(),
            positions: buffer.entire(),
            moves: moves.entire(),
        };
        let settle = kernels::Settle { u: gather.u, moves: moves.entire(), deformed: &view };
        let (gather, settle) = (pipelines.gather.bind(&gather), pipelines.settle.bind(&settle));
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

    /// Marks the field of `shape` as deforming field number `part`, and extends its bounds by [`MAX_DISPLACEMENT`].
    pub(super) fn widen(shape: &mut ShapeData, part: usize) {
        shape.deforms = part as u32 + 1;
        shape.size += MAX_DISPLACEMENT;
        shape.bound += MAX_DISPLACEMENT;
    }

    /// Writes the uniforms of a frame, and returns the half of the texture that belongs to it. `steps` is true if the
    /// frame has steps, `jumps` if the hair teleports.
    ///
    /// # Errors
    /// [`Error::Colliders`] if the number of poses does not match the parts, or a pose is not finite.
    pub(super) fn prepare(&mut self, steps: bool, jumps: bool) -> Result<u32> {
        if self.poses.len() != self.parts.len() {
            let (poses, parts) = (self.poses.len(), self.parts.len());
            return Err(Error::Colliders(format!("{poses} poses were given for {parts} deforming fields")));
        }
        for (part, pose) in self.parts.iter_mut().zip(&self.poses) {
            if !(pose.translation.is_finite() && pose.rotation.is_normalized()) {
                return Err(Error::Colliders("the pose of a deforming field is not finite".into()));
            }
            // Parts that teleport push nothing on their way, like colliders.
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
        self.buffer.write(0, &known);
        Ok(self.head.side)
    }

    /// Returns the half of the texture that belongs to this frame.
    pub(super) fn side(&self) -> u32 {
        self.head.side
    }

    /// Discards the skin's motion since the last frame: the next frame starts at the current deformation, without
    /// velocity.
    pub(crate) fn forget(&mut self) {
        self.fresh = true;
    }

    /// Records both kernels, after skinning and before the frame's first step.
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

/// Returns the nearest skin point of each node of a grid.
fn nearest(mesh: &TriMesh, triangles: &[[u32; 3]], low: Vec3, per_meter: Vec3) -> Result<Vec<DeformNode>> {
    if triangles.is_empty() || triangles.iter().flatten().any(|i| *i as usize >= mesh.positions.len()) {
        return Err(Error::unusable(
            "a deforming field has no triangles, or triangles with missing vertices",
        ));
    }
    let part =
        TriMesh { positions: mesh.positions.clone(), triangles: triangles.to_vec(), ..TriMesh::default() };
    let bvh = Bvh::new(&part);
    let node = |i: u32| {
        let at =
            UVec3::new(i % DEFORM_NODES, i / DEFORM_NODES % DEFORM_NODES, i / (DEFORM_NODES * DEFORM_NODES));
        let closest = bvh.closest_point(low + at.as_vec3() / per_meter);
        let closest =
            closest.ok_or_else(|| Error::unusable("the position of a deforming field is not finite"))?;
        let triangle = triangles[closest.triangle as usize];
        let [a, b, c] = closest.barycentric.to_array();
        let [p, q, r] = triangle.map(|i| mesh.positions[i as usize]);
        Ok(DeformNode { triangle, b, rest: a * p + b * q + c * r, c })
    };
    (0..PART).map(node).collect()
}
