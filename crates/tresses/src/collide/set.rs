//! The colliders of one groom on the GPU.

use super::{
    Anchor, Collider, ColliderDescriptor, ColliderPoses, FieldBuilder, FieldId, FieldSource, FieldVolume,
    Moments, PoseData, PoseHead, Shape, ShapeData, ShapeTable, SolidBounds,
    atlas::{Atlas, pack},
    build::Plan,
    deform::{self, DeformPoints, DeformTarget, Deformation, DeformingField},
    poses::{Journey, Track},
};
use crate::{
    Context, Error, Pose, Result,
    body::Skin,
    clock::{MAX_STEPS, MAX_SUBSTEPS, Mode},
    constants::MAX_COLLIDERS,
    gpu::{Binding, Device, Uniform, bindings},
    groom::TriMesh,
    math::map::Map,
    space::Passage,
};
use bytemuck::Zeroable;
use glam::{UVec3, Vec3};
use std::sync::Arc;

/// Bindings of `nearest.wesl`, in order.
const BINDINGS: [Binding; 5] =
    [Binding::Uniform, Binding::Storage, Binding::Texture3d, Binding::Sampler, Binding::Texture3d];

/// Returns the layout of `@group(1)` of every kernel with obstacles.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    bindings::layout(device, "colliders", wgpu::ShaderStages::COMPUTE, &BINDINGS)
}

/// A field before it is written to the atlas.
struct Field<'a> {
    size: UVec3,
    bias: Vec3,
    scale: Vec3,
    bounds: SolidBounds,
    texels: Texels<'a>,
}

/// Texels of a field, either from the CPU or to be built in the atlas.
enum Texels<'a> {
    Ready(FieldVolume),
    Planned(&'a FieldBuilder, Plan),
}

impl<'a> Field<'a> {
    fn new(source: FieldSource<'a>) -> Result<Self> {
        Ok(match source {
            FieldSource::Grid(grid) => {
                let volume = FieldVolume::new(grid);
                Self {
                    size: volume.size,
                    bias: volume.bias,
                    scale: volume.scale,
                    bounds: volume.bounds,
                    texels: Texels::Ready(volume),
                }
            }
            FieldSource::Mesh { builder, mesh, options } => {
                let plan = Plan::new(mesh, options)?;
                let (bias, scale) = FieldVolume::coordinates(&plan.grid);
                let (size, bounds) = (plan.grid.size, plan.bounds);
                Self { size, bias, scale, bounds, texels: Texels::Planned(builder, plan) }
            }
        })
    }
}

/// Tile of a field in the atlas.
#[derive(Clone, Copy, Debug)]
struct Tile {
    at: UVec3,
    size: UVec3,
    bias: Vec3,
    scale: Vec3,
    bounds: SolidBounds,
}

/// The distance fields that colliders refer to, on the GPU. Clones share them.
#[derive(Clone, Debug)]
pub(crate) struct FieldAtlas {
    context: Context,
    has_head: bool,
    atlas: Atlas,
    /// Tiles of all fields, the head's first.
    tiles: Arc<[Tile]>,
}

impl FieldAtlas {
    /// Uploads or builds the fields of `what`.
    ///
    /// # Errors
    /// [`Error::Colliders`] for more than [`MAX_COLLIDERS`], and for fields that are too large for a texture of the
    /// adapter.
    pub fn new(context: &Context, what: &ColliderDescriptor<'_>) -> Result<Self> {
        let has_head = what.head.is_some();
        // Check the list before fields are built.
        total(has_head, what.colliders)?;
        let sources = what.head.map(FieldSource::Grid).into_iter().chain(what.fields.iter().copied());
        let fields = sources.map(Field::new).collect::<Result<Vec<_>>>()?;
        let sizes: Vec<_> = fields.iter().map(|f| f.size).collect();
        let (positions, size) = pack(&sizes);
        let atlas = Atlas::new(&context.device, size)?;
        for (field, at) in fields.iter().zip(&positions) {
            match &field.texels {
                Texels::Ready(volume) => atlas.write(context, *at, volume),
                Texels::Planned(builder, plan) => builder.write(plan, &atlas.texture, *at)?,
            }
        }
        let tiles = fields.iter().zip(positions).map(|(field, at)| Tile {
            at,
            size: field.size,
            bias: field.bias,
            scale: field.scale,
            bounds: field.bounds,
        });
        Ok(Self { context: context.clone(), has_head, atlas, tiles: tiles.collect() })
    }

    /// Bytes of GPU memory: 8 per texel.
    pub fn bytes(&self) -> u64 {
        self.atlas.bytes()
    }
}

/// The colliders of one head and their state of motion.
#[derive(Debug)]
pub struct ColliderSet {
    fields: FieldAtlas,
    /// Deformation of fields with skin, after [`deform`](Self::deform).
    pub deformation: Option<Deformation>,
    /// Indices of the deforming fields, the head's first.
    deforming: Vec<usize>,
    track: Track,
    /// The colliders without the head's field.
    list: Vec<Collider>,
    /// Bounding spheres in the colliders' frames.
    spheres: Vec<(Vec3, f32)>,
    count: u32,
    table: Uniform,
    poses: Uniform,
    group: wgpu::BindGroup,
}

impl ColliderSet {
    /// Uploads the fields and creates the colliders.
    ///
    /// # Errors
    /// [`Error::Colliders`] for more than [`MAX_COLLIDERS`], a missing field, or fields that are too large for a
    /// texture of the adapter; [`Error::Parameter`] for an invalid size.
    pub fn new(context: &Context, what: &ColliderDescriptor<'_>) -> Result<Self> {
        Self::of(&FieldAtlas::new(context, what)?, what.colliders)
    }

    /// Creates `colliders` besides the head's own field.
    ///
    /// # Errors
    /// The errors of [`replace`](Self::replace).
    pub(crate) fn of(fields: &FieldAtlas, colliders: &[Collider]) -> Result<Self> {
        let device = &fields.context.device;
        let table = device.uniform(size_of::<ShapeTable>());
        let poses = device.storage_uniform(pose_bytes(1));
        let mut set = Self {
            group: bind(device, &table, &poses, &fields.atlas, &deform::none(device)),
            fields: fields.clone(),
            deformation: None,
            deforming: Vec::new(),
            track: Track::default(),
            list: Vec::new(),
            spheres: Vec::new(),
            count: 0,
            table,
            poses,
        };
        set.replace(colliders)?;
        Ok(set)
    }

    /// Replaces all colliders except the head's field, from the next frame on. The new list may have any length and
    /// other shapes, and may use the existing fields. A collider is identified by its index in the list: an existing
    /// one continues its motion, and a new one starts at its first pose without velocity. The frame's [`ColliderPoses`]
    /// must have the same length.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new); the previous colliders then remain.
    pub fn replace(&mut self, colliders: &[Collider]) -> Result<()> {
        let has_head = self.fields.has_head;
        let count = total(has_head, colliders)?;
        let mut table = Box::new(ShapeTable::zeroed());
        let mut anchors = Vec::with_capacity(count);
        let mut spheres = Vec::with_capacity(count);
        let first = usize::from(has_head);
        let head =
            has_head.then(|| Collider { anchor: Anchor::Head, ..Collider::new(Shape::Field(FieldId(0))) });
        for (slot, collider) in head.iter().chain(colliders).enumerate() {
            let data = &mut table.list[slot];
            *data = ShapeData::new(collider)?;
            anchors.push(collider.anchor);
            if let Shape::Field(FieldId(id)) = collider.shape {
                // The head's field precedes the indexed ones.
                let at = if slot < first { 0 } else { id as usize + first };
                let tile = self.fields.tiles.get(at).ok_or_else(|| {
                    Error::Colliders(format!(
                        "field {id} does not exist; the number of fields is {}",
                        self.fields.tiles.len() - first
                    ))
                })?;
                let SolidBounds { center, half, radius } = tile.bounds;
                (data.center, data.size, data.bound) = (center, half, radius);
                self.fields.atlas.write_coordinates(data, tile.at, tile.size, tile.bias, tile.scale);
                if let Some(part) = self.deforming.iter().position(|field| *field == at) {
                    Deformation::widen(data, part);
                }
            }
            spheres.push((data.center, data.bound));
        }
        let bytes = pose_bytes(count);
        if self.poses.size() < bytes as u64 {
            self.poses = self.fields.context.device.storage_uniform(bytes);
            self.regroup();
        }
        self.table.write(0, bytemuck::bytes_of(&*table));
        let count_at = std::mem::offset_of!(PoseHead, count) as u64;
        let side = self.deformation.as_ref().map_or(0, Deformation::side);
        // The count and `side`, which follows it.
        self.poses.write(count_at, bytemuck::bytes_of(&[count as u32, side]));
        self.track.replace(anchors);
        self.list = colliders.to_vec();
        (self.spheres, self.count) = (spheres, count as u32);
        Ok(())
    }

    fn regroup(&mut self) {
        let deformed = self.deformation.as_ref().map(|deformation| deformation.texture.clone());
        let device = &self.fields.context.device;
        let deformed = deformed.unwrap_or_else(|| deform::none(device));
        self.group = bind(device, &self.table, &self.poses, &self.fields.atlas, &deformed);
    }

    /// Lets `fields` deform with a skin from the next frame on; an empty slice stops all deformation. `mesh` is the
    /// skin at rest, in groom space, the frame of all these fields. `skin` has its vertices in each frame, and
    /// [`Deformation::poses`] the poses of the parts. See [`deform`].
    ///
    /// # Errors
    /// [`Error::Colliders`] for a missing field, and for more fields than a texture holds;
    /// [`crate::groom::Error::Unusable`] for triangles that `mesh` does not have, and for a skin that does not match
    /// it; [`Error::Limit`].
    pub fn deform(&mut self, mesh: &TriMesh, skin: &Skin<'_>, fields: &[DeformingField<'_>]) -> Result<()> {
        skin.positions.1.hold(skin.positions.0, mesh)?;
        let points = self.find_deform_points(mesh, fields)?;
        self.deform_with(points.as_ref(), skin)
    }

    /// Finds the points of `mesh`, at rest, with which the fields deform; `None` without fields.
    pub(crate) fn find_deform_points(
        &self,
        mesh: &TriMesh,
        fields: &[DeformingField<'_>],
    ) -> Result<Option<DeformPoints>> {
        let first = usize::from(self.fields.has_head);
        let (mut numbers, mut grids) = (Vec::new(), Vec::with_capacity(fields.len()));
        for field in fields {
            let at = match field.which {
                DeformTarget::Head => self.fields.has_head.then_some(0),
                DeformTarget::Field(FieldId(id)) => Some(id as usize + first),
            };
            let found = at.and_then(|at| Some((at, self.fields.tiles.get(at)?)));
            let (at, tile) = found
                .ok_or_else(|| Error::Colliders(format!("there is no field {:?} to deform", field.which)))?;
            numbers.push(at);
            let half = 0.5 / tile.size.as_vec3();
            let box_ = [half, 1.0 - half].map(|c| (c - tile.bias) / tile.scale);
            grids.push(deform::Grid { triangles: field.triangles, box_ });
        }
        if grids.is_empty() {
            return Ok(None);
        }
        DeformPoints::new(&self.fields.context, mesh, &grids, numbers).map(Some)
    }

    /// Lets fields deform at precomputed `places` with `skin`; `None` stops all deformation.
    pub(crate) fn deform_with(&mut self, points: Option<&DeformPoints>, skin: &Skin<'_>) -> Result<()> {
        let deformation =
            points.map(|points| Deformation::new(&self.fields.context, points, skin)).transpose()?;
        self.deformation = deformation;
        self.deforming = points.map_or_else(Vec::new, |points| points.fields.clone());
        self.regroup();
        self.replace(&self.list.clone())
    }

    /// Moves the colliders by one frame, to `poses` at its end. The caller does this before it records the frame's
    /// kernels.
    ///
    /// # Errors
    /// [`Error::Colliders`] if the number of poses does not match the colliders, or a pose is not finite.
    pub(crate) fn advance(&mut self, poses: &ColliderPoses, frame: &Moments<'_>) -> Result<()> {
        self.journey(poses, frame, &Journey { head: frame.head, passage: Passage::default() })
    }

    /// Like [`advance`](Self::advance), with poses in another space than the steps.
    pub(crate) fn journey(
        &mut self,
        poses: &ColliderPoses,
        frame: &Moments<'_>,
        journey: &Journey,
    ) -> Result<()> {
        let steps = &frame.steps[frame.steps.len().saturating_sub(MAX_STEPS as usize)..];
        let frame = Moments { steps, substeps: frame.substeps.clamp(1, MAX_SUBSTEPS), ..*frame };
        self.track.advance(self.fields.has_head, poses, &frame, journey)?;
        let jumps = steps.iter().any(|step| step.mode != Mode::Step);
        let deformation = self.deformation.as_mut();
        let side = deformation.map(|it| it.prepare(!steps.is_empty(), jumps)).transpose()?;
        if self.count == 0 {
            return Ok(());
        }
        let list = |poses: &[Pose]| -> Vec<PoseData> {
            let spheres = self.spheres.iter().cycle();
            poses.iter().zip(spheres).map(|(p, (center, bound))| PoseData::new(p, *center, *bound)).collect()
        };
        let header = size_of::<PoseHead>() as u64;
        let now = list(&self.track.now);
        self.poses.write(header, bytemuck::cast_slice(&now));
        if !steps.is_empty() {
            let interval = frame.step / frame.substeps as f32;
            let moments = steps.len() as u32 * frame.substeps;
            let pose_head = PoseHead { interval, moments, count: self.count, side: side.unwrap_or(0) };
            self.poses.write(0, bytemuck::bytes_of(&pose_head));
            let at = header + size_of_val(&*now) as u64;
            self.poses.write(at, bytemuck::cast_slice(&list(&self.track.moments)));
        }
        Ok(())
    }

    /// Converts the state of motion to another space, in which poses are given from here on.
    pub(crate) fn enter(&mut self, map: &Map) {
        self.track.enter(map);
    }

    /// Returns the bind group for `@group(1)`.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// Returns the number of colliders, including the head's field.
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Returns whether there are no colliders.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the poses for drawing the colliders, in the space in which hair is drawn: the head's field first if
    /// there is one, then the descriptor's colliders. Like the hair, they are one step behind (see the module
    /// documentation).
    pub fn drawn(&self) -> &[Pose] {
        &self.track.now
    }

    /// Returns the poses at all moments of the last frame with steps, collider fastest, in the space of the simulation
    /// ([`crate::space`]).
    pub fn moments(&self) -> &[Pose] {
        &self.track.moments
    }

    /// Bytes of GPU memory of this head alone.
    pub(crate) fn own_bytes(&self) -> u64 {
        let deformation = self.deformation.as_ref().map_or(0, Deformation::bytes);
        self.table.size() + self.poses.size() + deformation
    }
}

/// Returns the number of colliders, including the head's field.
fn total(has_head: bool, colliders: &[Collider]) -> Result<usize> {
    let count = colliders.len() + usize::from(has_head);
    if count > MAX_COLLIDERS as usize {
        return Err(Error::Colliders(format!(
            "{count} exceed the maximum of {MAX_COLLIDERS}, including the head"
        )));
    }
    Ok(count)
}

/// Returns the bytes of the places of `count` colliders: those at all moments of a frame and at drawing time, and the
/// header.
fn pose_bytes(count: usize) -> usize {
    ((MAX_STEPS * MAX_SUBSTEPS + 2) as usize * count.max(1) + 1) * size_of::<PoseData>()
}

fn bind(
    device: &Device,
    table: &Uniform,
    poses: &Uniform,
    atlas: &Atlas,
    deformed: &wgpu::Texture,
) -> wgpu::BindGroup {
    let sampler = bindings::linear_sampler(device);
    device.group(
        "colliders",
        &layout(device),
        &[
            table.as_entire_binding(),
            poses.as_entire_binding(),
            wgpu::BindingResource::TextureView(&atlas.texture.create_view(&Default::default())),
            wgpu::BindingResource::Sampler(&sampler),
            wgpu::BindingResource::TextureView(&deformed.create_view(&Default::default())),
        ],
    )
}
