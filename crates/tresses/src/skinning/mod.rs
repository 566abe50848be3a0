//! Skinned meshes: blend shapes and linear blend skinning.
//!
//! The stage computes a body's vertices from a [`Rig`] once per frame. It adds the weighted deltas of all blend shapes
//! to a vertex, then transforms the sum by up to eight joints. The CPU computes the joint matrices ([`Rig::pose`]), a
//! few dozen; nothing is read back. Hair follows by its [roots](crate::roots).
//!
//! ```text
//! bound vertices, deltas (once) ─┐
//! palette, shapes (each frame)  ─┴─► skin ─► the body's vertices ─► roots, light, draw
//! ```
//!
//! Memory: 64 bytes per vertex, and 32 per vertex that a blend shape moves. Weights are 16-bit fractions that sum to
//! one within 8e-6, so a vertex of a body 2 m tall is within 15 µm of the CPU reference (`tests/stages/skinning`).
//!
//! **Why not in the vertex shader?** Shadow maps, light, roots and drawing all read the vertices. A host that already
//! skins them can write the body's buffer instead ([`Body::vertices`]), or pass its own to [`crate::body::Skin`].
//!
//! **Limits.** No dual quaternions: twisted wrists get thinner, as with the default skinning of every engine.

use crate::{
    Context, Error, Result,
    body::Body,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, Kernel, PipelineSet, Uniform},
    groom::rig::{Rig, RigPose},
    shaders::kernels::skinning as kernels,
    strands::buffers::filled,
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A vertex with its joints and weights.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct SkinVertex {
    /// Position in the space of the file's mesh.
    pub position: Vec3,
    /// Index of the first of its deltas.
    pub first: u32,
    /// Unit normal.
    pub normal: Vec3,
    /// Number of its deltas.
    pub count: u32,
    /// Eight palette indices, 16 bits each.
    pub joints: [u32; 4],
    /// Eight weights, as 16-bit fractions.
    pub weights: [u32; 4],
}

/// Delta of a blend shape for one vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct SkinDelta {
    /// Added to the position.
    pub position: Vec3,
    /// Index of the blend shape.
    pub shape: u32,
    /// Added to the normal.
    pub normal: Vec3,
    /// Unused.
    pub _pad: u32,
}

/// The pipeline of the stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    skin: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        Self { skin: Kernel::new::<kernels::Skin>(&context.device) }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.skin]
    }
}

/// The rig of a mesh on the GPU.
#[derive(Debug)]
pub(crate) struct SkinAsset {
    context: Context,
    /// Counts, vertices, deltas.
    buffers: [wgpu::Buffer; 3],
    vertices: u32,
    /// Bounding box of each joint's vertices, in the space of the file's mesh; inverted for joints without vertices.
    boxes: Vec<[Vec3; 2]>,
    /// Largest displacement by each blend shape.
    max_displacements: Vec<f32>,
}

impl SkinAsset {
    /// Uploads `rig`, which bends the mesh of `body`.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for the rig of another mesh, and for a rig with vertices that refer to missing
    /// joints; [`Error::Limit`] if a buffer exceeds the device's limits.
    pub fn new(context: &Context, rig: &Rig, body: &Body) -> Result<Self> {
        let count = rig.vertices.len() as u64;
        if count * u64::from(Body::WORDS) * 4 != body.vertex_buffer().size() || count == 0 {
            return Err(Error::unusable(format!("the rig has {count} vertices and does not match the body")));
        }
        let joints = rig.joints.len();
        let lost = |v: &crate::groom::rig::Bind| v.joints.iter().any(|joint| usize::from(*joint) >= joints);
        if rig.vertices.iter().any(lost) {
            return Err(Error::unusable("a vertex of the rig refers to a missing joint"));
        }
        let (vertices, deltas) = packed(rig)?;
        let upload = |what, bytes: &[u8]| filled(context, what, bytes);
        let counts = [count as u32, Body::WORDS];
        let max_displacement = |target: &crate::groom::rig::MorphTarget| {
            target.deltas.iter().map(|delta| delta.position.length()).fold(0.0, f32::max)
        };
        Ok(Self {
            context: context.clone(),
            buffers: [
                upload("skin counts", bytemuck::cast_slice(&counts))?,
                upload("skin vertices", bytemuck::cast_slice(&vertices))?,
                upload("skin deltas", bytemuck::cast_slice(&deltas))?,
            ],
            vertices: counts[0],
            boxes: boxes(rig),
            max_displacements: rig.targets.iter().map(max_displacement).collect(),
        })
    }
}

/// Skins one body.
#[derive(Debug)]
pub(crate) struct Skinning {
    pipelines: Arc<Pipelines>,
    asset: Arc<SkinAsset>,
    palette: Uniform,
    shapes: Uniform,
    group: wgpu::BindGroup,
    /// Current pose.
    pose: RigPose,
    /// Whether the pose has changed since the last recording.
    due: AtomicBool,
}

impl Skinning {
    /// Skins `body`, which must have been created from the mesh of `rig`.
    #[cfg(test)]
    pub fn new(context: &Context, rig: &Rig, body: &Body) -> Result<Self> {
        Self::of(&Arc::new(SkinAsset::new(context, rig, body)?), body)
    }

    /// Skins `body`, an instance of the one that the asset was created for, with vertices of its own.
    pub(crate) fn of(asset: &Arc<SkinAsset>, body: &Body) -> Result<Self> {
        let SkinAsset { context, buffers: [counts, bound, moves], boxes, max_displacements, .. } = &**asset;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let palette = context.device.storage_uniform(size_of::<Mat4>() * boxes.len());
        let shapes = context.device.storage_uniform(size_of::<f32>() * max_displacements.len());
        let group = pipelines.skin.bind(&kernels::Skin {
            counts: counts.entire(),
            bound: bound.entire(),
            deltas: moves.entire(),
            palette: palette.entire(),
            shapes: shapes.entire(),
            vertices: body.vertex_buffer().entire(),
        });
        let (pose, due) = (RigPose::default(), AtomicBool::new(false));
        Ok(Self { pipelines, asset: asset.clone(), palette, shapes, group, pose, due })
    }

    /// Sets the pose of `body` from the next frame on. Returns whether it differs from the current one. A pose is
    /// recorded only once, so the caller must submit the frame that records it.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for the pose of another rig.
    pub fn pose(&mut self, pose: &RigPose, body: &mut Body) -> Result<bool> {
        if pose.palette.len() != self.asset.boxes.len()
            || pose.weights.len() != self.asset.max_displacements.len()
        {
            return Err(Error::unusable("the pose does not match the body's rig"));
        }
        if (&pose.palette, &pose.weights) == (&self.pose.palette, &self.pose.weights) {
            return Ok(false);
        }
        self.due.store(true, Ordering::Relaxed);
        self.pose.clone_from(pose);
        self.palette.write(0, bytemuck::cast_slice(&pose.palette));
        self.shapes.write(0, bytemuck::cast_slice(&pose.weights));
        body.set_bounds(self.bounds(pose));
        body.mark_deformed();
        Ok(true)
    }

    /// Makes the next pose due: the body's vertices have been overwritten.
    pub(crate) fn forget(&mut self) {
        self.pose = RigPose::default();
    }

    /// Bounding box of the body in `pose`, groom space, meters. A vertex is a weighted mean of its positions under each
    /// joint.
    fn bounds(&self, pose: &RigPose) -> [Vec3; 2] {
        let further: f32 = pose
            .weights
            .iter()
            .zip(&self.asset.max_displacements)
            .map(|(w, displacement)| w.abs() * displacement)
            .sum();
        let mut out = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        for (matrix, [lo, hi]) in pose.palette.iter().zip(&self.asset.boxes) {
            if lo.cmpgt(*hi).any() {
                continue;
            }
            let (lo, hi) = (*lo - further, *hi + further);
            for corner in 0..8u32 {
                let pick = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
                let at = matrix.transform_point3(Vec3::select(pick, hi, lo));
                out = [out[0].min(at), out[1].max(at)];
            }
        }
        out
    }

    /// Records the skinning if the pose has changed since the last recording.
    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        if !self.due.swap(false, Ordering::Relaxed) {
            return;
        }
        self.pipelines.skin.record(pass, &self.group, &[], self.asset.vertices.div_ceil(STRAND_WORKGROUP));
    }
}

/// Converts vertices and deltas to the layout of the GPU.
fn packed(rig: &Rig) -> Result<(Vec<SkinVertex>, Vec<SkinDelta>)> {
    let mut counts = vec![0u32; rig.vertices.len()];
    for delta in rig.targets.iter().flat_map(|target| &target.deltas) {
        let count = counts.get_mut(delta.vertex as usize);
        *count.ok_or_else(|| Error::unusable("a blend shape of the rig refers to a missing vertex"))? += 1;
    }
    let mut next = 0u32;
    let mut firsts = Vec::with_capacity(counts.len());
    for count in &counts {
        firsts.push(next);
        next += count;
    }
    let mut slots = firsts.clone();
    let mut deltas = vec![SkinDelta::default(); (next as usize).max(1)];
    for (shape, target) in rig.targets.iter().enumerate() {
        for delta in &target.deltas {
            let slot = &mut slots[delta.vertex as usize];
            let (position, normal, shape) = (delta.position, delta.normal, shape as u32);
            deltas[*slot as usize] = SkinDelta { position, shape, normal, _pad: 0 };
            *slot += 1;
        }
    }
    let vertices = rig.vertices.iter().zip(counts).zip(firsts).map(|((bind, count), first)| {
        let weights = fractions(bind.weights);
        let pair = |values: [u16; 8]| {
            std::array::from_fn(|i| u32::from(values[2 * i]) | u32::from(values[2 * i + 1]) << 16)
        };
        // A joint with zero weight is not read, so its index does not matter.
        SkinVertex {
            position: bind.position,
            first,
            normal: bind.normal,
            count,
            joints: pair(bind.joints),
            weights: pair(weights),
        }
    });
    Ok((vertices.collect(), deltas))
}

/// Converts weights to 16-bit fractions whose sum is as close as possible to the weights' sum. The rounding error goes
/// to the largest weight.
fn fractions(weights: [f32; 8]) -> [u16; 8] {
    let total = f64::from(weights.iter().sum::<f32>()).clamp(0.0, 1.0) * 65_535.0;
    let mut out = weights.map(|w| (w.clamp(0.0, 1.0) * 65_535.0).round() as u16);
    let largest = (0..8).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap_or(0);
    let left = total.round() as i64 - out.iter().map(|w| i64::from(*w)).sum::<i64>();
    out[largest] = (i64::from(out[largest]) + left).clamp(0, 65_535) as u16;
    out
}

fn boxes(rig: &Rig) -> Vec<[Vec3; 2]> {
    let mut boxes = vec![[Vec3::INFINITY, Vec3::NEG_INFINITY]; rig.joints.len()];
    for vertex in &rig.vertices {
        for (joint, weight) in vertex.joints.iter().zip(vertex.weights) {
            if weight > 0.0 {
                let [lo, hi] = &mut boxes[usize::from(*joint)];
                (*lo, *hi) = (lo.min(vertex.position), hi.max(vertex.position));
            }
        }
    }
    boxes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_sum_to_one() {
        for weights in
            [[0.125; 8], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.3, 0.3, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0]]
        {
            let out = fractions(weights);
            assert_eq!(out.iter().map(|w| u32::from(*w)).sum::<u32>(), 65_535, "{weights:?}");
            let off = out.iter().zip(weights).map(|(a, b)| (f32::from(*a) / 65_535.0 - b).abs());
            assert!(off.fold(0.0, f32::max) < 4.0 / 65_535.0);
        }
        assert_eq!(fractions([0.0; 8]), [0; 8]);
        assert_eq!(fractions([f32::NAN, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])[2..], [0; 6]);
    }
}
