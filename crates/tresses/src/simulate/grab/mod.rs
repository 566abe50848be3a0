//! Grabbing and pulling a lock of hair, and [brushes](MotionBrush) on moving hair.
//!
//! ```text
//! at the grab:  ray, strand vertices ─► pick ─► marks ─► hit ─► state: hit point on hair
//!               guides ─► reach ─► marks ─► hold ─► holds: offset from the hit point and weight, per vertex
//! each step:    ray or point ─► aim ─► state: motion of the target in this step
//!               holds, guides, obstacles ─► pull ─► GuideForce ─► simulate::step
//! a brush:      pick, hit and reach in each frame; in each step aim, then guides, obstacles ─► sweep ─► GuideForce
//! ```
//!
//! **Picking.** `pick` is an atomic minimum over the drawn segments near the ray, because the user sees those. It
//! minimizes depth plus [`RAY_DISTANCE_WEIGHT`] times the distance from the ray, so that hair under the cursor wins
//! over slightly nearer hair beside it. `hit` tests the obstacles along the ray, so hair behind the head is not
//! grabbed. `reach` finds the distance of the nearest guide vertex from the hit point, because guides may be farther
//! apart than the radius. `hold` stores, for all vertices within the radius or up to twice that distance, the offset
//! from the hit point and a weight that falls to 0 at the edge.
//!
//! **Pull.** Each held vertex has a target: its position if it had moved with the grab's target. The pull is a rate
//! towards a velocity, `RATE (w − v)`, where `w` is the target's velocity plus the remaining offset over [`SETTLE`]. It
//! is critically damped by construction, since only the velocity has inertia. The step treats the rate implicitly in
//! the velocity, like drag, so it is stable at any strength. A force stiff in the position would need a term in the
//! solve and a ninth storage buffer, which WebGPU does not guarantee. The acceleration is at most [`STRONGEST`]: hair
//! pulled beyond its length becomes taut, and the energy it stores is too small to see on release. Near an obstacle `w`
//! leads no deeper than its surface.
//!
//! **Nothing is read back.** The host does not know whether the ray hit anything. A ray without a hit holds nothing,
//! and the guides move bit-identically without it. A target given by a ray lies in the plane through the hit point,
//! perpendicular to the ray of the grab.
//!
//! **Fixed steps.** The target moves from its position at the end of the last step towards its current position, in
//! fractions of the frame, like the head ([`crate::clock`]): the motion is the same at any frame rate. The hair is
//! released when the head jumps or the hair is reset to rest.
//!
//! **Cost.** Buffers and pipelines are created at the first grab; without a grab, nothing is dispatched. During a grab
//! there are two small kernels per step, and `simulate::step` reads their forces.
//!
//! **Measured** (`tests/gpu/grab.rs`): held hair is within 1.5 mm of its target half a second after a drag of 3 cm.
//! When pulled out of reach and through the head, no edge is more than 0.82 % from its rest length and no vertex is in
//! the head. Released from there, hair moves at 0.5 m/s after a step and never faster than 2.1 m/s. Positions at 30, 60
//! and 144 frames per second differ by 2 µm.
//!
//! **Known limit.** Strands between a held guide and a free one are interpolated between both: where guides are sparse,
//! a lifted lock is a fan.
//!
//! **Untried.** Rotating a lock by hand; grabbing single drawn strands, which follow the guides.

mod brush;
mod kernels;

pub use brush::{BrushEffect, MotionBrush};
pub(crate) use kernels::GrabKernels;

use super::{Pipelines, SimulationParams};
use crate::{
    Context, Error, Result,
    clock::{MAX_STEPS, MAX_SUBSTEPS, Mode, Step},
    collide::ColliderSet,
    constants::{STRAND_WORKGROUP, VOLUME_WORKGROUP},
    math::Ray,
    math::map::Map,
    strands::{GuideBuffers, StrandBuffers, buffers::storage},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::sync::Arc;

/// Weight of the distance from the ray relative to the depth along it.
pub const RAY_DISTANCE_WEIGHT: f32 = 3.0;
/// Time constant with which a held vertex's remaining offset decays, s; at least two steps.
pub const SETTLE: f32 = 0.03;
/// Time constant with which a brush follows the hair in depth, s.
pub const FOLLOW: f32 = 0.04;
/// Largest acceleration of a guide vertex by the pull, m/s².
pub const STRONGEST: f32 = 2000.0;

/// Target to which a grab pulls hair.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum GrabTarget {
    /// The intersection of a ray with the plane through the hit point, perpendicular to the ray of the grab.
    Ray(Ray),
    /// A point in the space of the rays, meters, to which the hit point is pulled.
    Point(Vec3),
}

/// Uniforms of a grab in one step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct GrabUniform {
    /// Origin of the ray of the grab, meters.
    pub origin: Vec3,
    /// Radius around the hit point within which guide vertices are held, meters.
    pub radius: f32,
    /// Direction of the ray of the grab, unit.
    pub direction: Vec3,
    /// Fraction of the target's remaining path in the frame that this step covers.
    pub path_fraction: f32,
    /// Origin of the target ray, or the target point, meters.
    pub target_at: Vec3,
    /// Length of the step, s.
    pub step: f32,
    /// Direction of the target ray, unit; zero for a point.
    pub toward: Vec3,
    /// [`SETTLE`], but at least two steps, s.
    pub settle: f32,
    /// Number of guides.
    pub guide_count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Number of drawn strands.
    pub strand_count: u32,
    /// Vertices per strand.
    pub strand_vertices: u32,
    /// 1 if the force buffer already holds other forces.
    pub forced: u32,
    /// Collider moment at the start of the step, see [`crate::collide`].
    pub moment: u32,
    /// [`RAY_DISTANCE_WEIGHT`].
    pub ray_distance_weight: f32,
    /// [`STRONGEST`], m/s².
    pub strongest: f32,
    /// Origin of the ray of the grab in the space of the drawn frame, which has the obstacles, meters.
    pub frame_origin: Vec3,
    /// [`BrushEffect`] of a brush, 0 for a grab.
    pub effect: u32,
    /// Direction of that ray, unit.
    pub frame_direction: Vec3,
    /// Strength of a brush.
    pub strength: f32,
    /// Origin of the ray of the grab in the space in which strands were last drawn, meters.
    pub drawn_origin: Vec3,
    /// [`MotionBrush::root_tip`].
    pub root_tip: f32,
    /// Direction of that ray, unit.
    pub drawn_direction: Vec3,
    /// 1 in the first step of a brush.
    pub begins: u32,
    /// Displacement of the state before the step, meters, when the carrier's origin has moved.
    pub shift: Vec3,
    /// 1 if a brush is mirrored.
    pub mirrors: u32,
    /// Point on the plane of the mirror, meters.
    pub mirror_at: Vec3,
    /// Share of the change of depth that a brush follows in this frame.
    pub follow: f32,
    /// Normal of that plane, unit.
    pub mirror_normal: Vec3,
    /// Unused.
    pub _pad_a: u32,
}

/// Maps from the space of the drawn frame, in which rays are given.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RayTransforms {
    /// Map to the space of the simulation.
    pub to_carrier: Map,
    /// Map to the space of the last drawn frame.
    pub to_last: Map,
    /// Displacement of all positions before the first step, meters.
    pub shift: Vec3,
}

/// State of a grab on the GPU.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GrabState {
    /// Hit point of the ray on hair, meters.
    pub hit: Vec3,
    /// 1 if the ray has hit hair, else 0.
    pub held: u32,
    /// Position of the target at the end of the step, meters.
    pub at: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// Velocity of the target in the step, m/s.
    pub velocity: Vec3,
    /// Unused.
    pub _pad_b: u32,
}

/// Stride between the uniforms of consecutive steps, bytes: a multiple of every adapter's alignment.
const STRIDE: u32 = 256;

/// The grab of one groom.
#[derive(Debug, Default)]
pub struct Grab {
    hand: Option<Hand>,
    /// Whether the ray has not been cast yet.
    fresh: bool,
    /// Whether this frame casts the ray.
    picks: bool,
    pub(super) buffers: Option<Buffers>,
    /// Number of strand vertices and of guide vertices.
    threads: [u32; 2],
}

/// A grab or a brush, while it lasts.
#[derive(Clone, Copy, Debug)]
enum Hand {
    /// Ray, radius and target of a grab.
    Lock(Ray, f32, GrabTarget),
    /// A brush and its current ray.
    Brush(MotionBrush, Ray),
}

/// GPU resources of a grab.
#[derive(Debug)]
pub(super) struct Buffers {
    pipelines: Arc<Pipelines>,
    own: kernels::GrabBuffers,
    groups: kernels::Groups,
}

fn unit(ray: &Ray) -> Result<Ray> {
    let direction = ray.direction.normalize_or_zero();
    if !(ray.origin.is_finite() && direction.is_normalized()) {
        return Err(Error::Parameter {
            name: "grab ray",
            value: format!("{ray:?}"),
            range: "finite, with a direction",
        });
    }
    Ok(Ray { origin: ray.origin, direction })
}

impl Grab {
    /// Grabs all guide vertices within `radius` meters of the first hair that `ray` hits. The ray is cast before the
    /// next step, against the hair as it was last drawn.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a ray without a direction, and for a radius outside 1 mm to 1 m.
    pub fn begin(&mut self, ray: &Ray, radius: f32) -> Result<()> {
        Error::unless_within("grab radius", radius, 1e-3, 1.0, "from 0.001 to 1 m")?;
        let ray = unit(ray)?;
        self.hand = Some(Hand::Lock(ray, radius, GrabTarget::Ray(ray)));
        self.fresh = true;
        Ok(())
    }

    /// Puts `brush` on the hair under `ray`, or moves it there from its last place.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a ray without a direction, and as [`MotionBrush::check`].
    pub fn brush(&mut self, brush: &MotionBrush, ray: &Ray) -> Result<()> {
        brush.check()?;
        self.fresh |= !matches!(self.hand, Some(Hand::Brush(..)));
        self.hand = Some(Hand::Brush(*brush, unit(ray)?));
        Ok(())
    }

    /// Moves the target of a grab. Does nothing without one.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a target that is not finite.
    pub fn drag(&mut self, target: &GrabTarget) -> Result<()> {
        let target = match target {
            GrabTarget::Ray(ray) => GrabTarget::Ray(unit(ray)?),
            GrabTarget::Point(point) if point.is_finite() => GrabTarget::Point(*point),
            GrabTarget::Point(point) => {
                return Err(Error::Parameter {
                    name: "grab target",
                    value: point.to_string(),
                    range: "finite",
                });
            }
        };
        if let Some(Hand::Lock(.., now)) = &mut self.hand {
            *now = target;
        }
        Ok(())
    }

    /// Releases the hair.
    pub fn end(&mut self) {
        (self.hand, self.fresh, self.picks) = (None, false, false);
    }

    /// Returns whether a grab or a brush is active, even if its ray has hit nothing.
    pub fn is_active(&self) -> bool {
        self.hand.is_some()
    }

    /// Returns the buffer with the [`GrabState`], after the first grab.
    pub fn state(&self) -> Option<&wgpu::Buffer> {
        self.buffers.as_ref().map(|buffers| &buffers.own.state)
    }

    /// Releases the hair and drops the buffers, because the hair's strands have new buffers.
    pub(crate) fn forget_buffers(&mut self) {
        if self.buffers.take().is_some() {
            self.end();
        }
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffers.as_ref().map_or(0, |buffers| {
            let own = &buffers.own;
            let buffers: u64 = [&own.marks, &own.state, &own.holds].iter().map(|buffer| buffer.size()).sum();
            own.uniforms.size() + buffers
        })
    }

    /// Writes the uniforms of a frame's `steps` and returns whether any of them pulls. `forced` is true if other
    /// kernels have written [`GuideBuffers::forces`].
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn prepare(
        &mut self,
        context: &Context,
        physics: &SimulationParams,
        steps: &[Step],
        (guides, strands): (&GuideBuffers, &StrandBuffers),
        transforms: &RayTransforms,
        forced: bool,
    ) -> Result<bool> {
        let Context { queue, .. } = context;
        if steps.iter().any(|step| step.mode != Mode::Step) {
            self.end();
        }
        let Some(hand) = self.hand else { return Ok(false) };
        let steps = &steps[steps.len().saturating_sub(MAX_STEPS as usize)..];
        if steps.is_empty() {
            self.picks = false;
            return Ok(false);
        }
        let (brush, ray, radius, target) = match hand {
            Hand::Lock(ray, radius, target) => (None, ray, radius, target),
            Hand::Brush(brush, ray) => (Some(brush), ray, brush.radius, GrabTarget::Ray(ray)),
        };
        let begins = std::mem::take(&mut self.fresh);
        self.picks = begins || brush.is_some();
        if self.buffers.is_none() {
            self.buffers = Some(Buffers::new(context, guides, strands)?);
        }
        let Some(buffers) = &self.buffers else { return Ok(false) };
        let (target, toward) = match target {
            GrabTarget::Ray(ray) => (ray.origin, ray.direction),
            GrabTarget::Point(point) => (point, Vec3::ZERO),
        };
        let (frame_ray, drawn) = (ray, transforms.to_last.ray(&ray));
        let ray = transforms.to_carrier.ray(&ray);
        let (target, toward) = (transforms.to_carrier.at(target), transforms.to_carrier.vector(toward));
        let (mirror_at, mirror_normal) = brush.and_then(|brush| brush.mirror).unwrap_or_default();
        let follow = 1.0 - (-(steps.len() as f32) * physics.step / FOLLOW).exp();
        let substeps = physics.substep_count.clamp(1, MAX_SUBSTEPS);
        let mut bytes = vec![0u8; STRIDE as usize * steps.len()];
        for (i, (step, slot)) in steps.iter().zip(bytes.chunks_mut(STRIDE as usize)).enumerate() {
            let uniform = GrabUniform {
                origin: ray.origin,
                radius,
                direction: ray.direction,
                path_fraction: ((step.to - step.from) / (1.0 - step.from).max(1e-6)).clamp(0.0, 1.0),
                target_at: target,
                step: physics.step,
                toward,
                settle: SETTLE.max(2.0 * physics.step),
                guide_count: guides.count,
                vertex_count: guides.vertex_count,
                strand_count: strands.drawn.count,
                strand_vertices: strands.drawn.vertex_count,
                forced: forced.into(),
                moment: i as u32 * substeps,
                ray_distance_weight: RAY_DISTANCE_WEIGHT,
                strongest: STRONGEST,
                frame_origin: frame_ray.origin,
                frame_direction: frame_ray.direction,
                drawn_origin: drawn.origin,
                drawn_direction: drawn.direction,
                effect: brush.map_or(0, |brush| brush.effect as u32),
                strength: brush.map_or(0.0, |brush| brush.strength),
                root_tip: brush.map_or(0.0, |brush| brush.root_tip),
                begins: u32::from(begins && i == 0),
                mirrors: u32::from(mirror_normal != Vec3::ZERO),
                follow,
                mirror_at: transforms.to_carrier.at(mirror_at),
                mirror_normal: transforms.to_carrier.vector(mirror_normal),
                // A hit in the first step of a grab is already relative to the new origin.
                shift: if i == 0 && !begins { transforms.shift } else { Vec3::ZERO },
                ..Zeroable::zeroed()
            };
            slot[..size_of::<GrabUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        buffers.own.uniforms.write(0, &bytes);
        if self.picks {
            queue.write_buffer(&buffers.own.marks, 0, bytemuck::cast_slice(&[u32::MAX; 2]));
        }
        self.threads = [strands.drawn.count * strands.drawn.vertex_count, guides.count * guides.vertex_count];
        Ok(true)
    }

    /// Records step `i` of those written by [`prepare`](Self::prepare), after other forces and before the step.
    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, colliders: &ColliderSet, i: u32) {
        let Some(buffers) = &self.buffers else { return };
        if self.is_active() {
            let [strands, guides] = self.threads;
            let workgroups = [strands.div_ceil(STRAND_WORKGROUP), guides.div_ceil(VOLUME_WORKGROUP)];
            pass.set_bind_group(1, colliders.group(), &[]);
            buffers.pipelines.grab.record(
                pass,
                &buffers.groups,
                workgroups,
                i * STRIDE,
                (self.picks && i == 0, matches!(self.hand, Some(Hand::Brush(..)))),
            );
        }
    }
}

impl Buffers {
    fn new(context: &Context, guides: &GuideBuffers, strands: &StrandBuffers) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let uniforms = device.uniform((STRIDE * MAX_STEPS) as usize);
        let marks = storage::<u32>(device, "grab marks", 4)?;
        let state = storage::<GrabState>(device, "grab state", 1)?;
        let holds = storage::<[f32; 4]>(
            device,
            "grab holds",
            u64::from(guides.count) * u64::from(guides.vertex_count),
        )?;
        let own = kernels::GrabBuffers { uniforms, marks, state, holds };
        let groups = pipelines.grab.bind(&own, guides, strands);
        Ok(Self { pipelines, own, groups })
    }
}
