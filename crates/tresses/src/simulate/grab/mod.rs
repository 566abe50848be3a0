//! Grabbing and pulling a lock of hair.
//!
//! ```text
//! at the grab:  ray, strand vertices ─► pick ─► marks ─► hit ─► state: where the ray has met hair
//!               guides ─► reach ─► marks ─► hold ─► holds: offset from there and weight, per guide vertex
//! each step:    ray or point ─► aim ─► state: the motion of the target in this step
//!               holds, guides, obstacles ─► pull ─► GuideForce ─► simulate::step
//! ```
//!
//! **What is grabbed.** `pick` is an atomic minimum over the drawn segments near the ray, since those are
//! what the user sees: depth plus [`ASIDE`] times the distance from the ray, so that hair under the cursor
//! wins over hair a little nearer beside it. `hit` tests the obstacles along the ray: hair behind the head
//! is not grabbed. `reach` finds the distance of the nearest guide vertex from the hit point, because
//! guides may be farther apart than the radius; `hold` stores, for all vertices within the radius or
//! slightly more than that distance, the offset from the hit point and a weight that falls to 0 at the
//! edge.
//!
//! **What pulls.** The target of each held vertex is where it would be if it had moved with the grab's
//! target. The pull is a rate towards a velocity, `RATE (w − v)`, and `w` is the target's velocity plus the
//! remaining offset over [`SETTLE`]: critically damped by construction, since nothing but the velocity has
//! inertia. The step treats the rate implicitly in the velocity, as it does drag, so that no strength is
//! unstable; a force stiff in the position would need a term in the solve, which has no ninth buffer. The
//! acceleration is at most [`STRONGEST`]: hair pulled beyond its length becomes taut, and the energy
//! that it stores is too small to see on release. Near an obstacle `w` leads no deeper than its surface.
//!
//! **Nothing is read back.** The host knows neither what was hit nor whether anything was; a ray that meets
//! nothing holds nothing, and the guides move bit-identically without it. A target given by a ray lies in
//! the plane through the hit point, perpendicular to the ray of the grab.
//!
//! **Fixed steps.** The target moves from its position at the end of the last step towards its current
//! position, in fractions of the frame, as the head does ([`crate::clock`]): the same motion at any frame
//! rate. The hair is released when the head jumps or the hair is reset to rest.
//!
//! **Cost.** Buffers and pipelines are created at the first grab; without a grab, nothing is dispatched.
//! During a grab there are two small kernels per step, and `simulate::step` reads their forces.
//!
//! **Measured** (`tests/gpu/grab.rs`): held hair is within 1.5 mm of its target half a second after a drag of
//! 3 cm; pulled out of reach, and through the head, no edge is more than 0.82 % from its rest length and no
//! vertex in the head; released from there it moves at 0.5 m/s after a step and never faster than 2.1 m/s.
//! At 30, 60 and 144 frames per second positions differ by 2 µm.
//!
//! **Known limit.** Strands between a held guide and a free one are interpolated between both: where guides
//! are sparse, a lifted lock is a fan.
//!
//! **Untried.** Rotating a lock by hand; grabbing drawn strands alone, which follow the guides.

mod kernels;

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

/// How much a millimetre beside the ray counts of a millimetre along it.
pub const ASIDE: f32 = 3.0;
/// Time in which a held vertex makes good a third of what it has stayed behind, s; but no less than two steps.
pub const SETTLE: f32 = 0.03;
/// The strongest pull on a guide vertex, m/s².
pub const STRONGEST: f32 = 2000.0;

/// Where the hand is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Where a ray meets the plane through the place that was hit, across the ray of the grab.
    Ray(Ray),
    /// At a point of the same space, metres: there what was hit wants to be.
    Point(Vec3),
}

/// What the kernels know of a grab in one step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GrabUniform {
    /// Origin of the ray of the grab, metres.
    pub origin: Vec3,
    /// How near to what was hit guide vertices are held, metres.
    pub radius: f32,
    /// Direction of the ray of the grab, unit.
    pub direction: Vec3,
    /// Of the way from where the target is to where the frame wants it, the share of this step.
    pub share: f32,
    /// Origin of the ray of the target, or the target, metres.
    pub target_at: Vec3,
    /// Length of the step, s.
    pub step: f32,
    /// Direction of the ray of the target, unit; zero for a point.
    pub toward: Vec3,
    /// [`SETTLE`], or two steps, s.
    pub settle: f32,
    /// Number of guides.
    pub guide_count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Number of drawn strands.
    pub strand_count: u32,
    /// Vertices of each.
    pub strand_vertices: u32,
    /// 1 when other forces stand in the buffer already.
    pub forced: u32,
    /// The moment at which the step begins, see [`crate::collide`].
    pub moment: u32,
    /// [`ASIDE`].
    pub aside: f32,
    /// [`STRONGEST`], m/s².
    pub strongest: f32,
    /// Origin of the ray of the grab as obstacles are drawn, metres.
    pub seen_origin: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// Its direction, unit.
    pub seen_direction: Vec3,
    /// Unused.
    pub _pad_b: u32,
    /// The same as strands were drawn last.
    pub drawn_origin: Vec3,
    /// Unused.
    pub _pad_c: u32,
    /// Its direction, unit.
    pub drawn_direction: Vec3,
    /// Unused.
    pub _pad_d: u32,
    /// By how much the state moves before the step, metres: the origin is another one.
    pub shift: Vec3,
    /// Unused.
    pub _pad_e: u32,
}

/// The ways of rays, which are given as the frame is drawn.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sights {
    /// To where hair is simulated.
    pub to_carrier: Map,
    /// To where the last frame was drawn.
    pub to_last: Map,
    /// By how much positions move before the first step, metres.
    pub shift: Vec3,
}

/// What the GPU remembers of a grab.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GrabState {
    /// Where the ray has met hair, metres.
    pub hit: Vec3,
    /// 1 when it has, else 0.
    pub held: u32,
    /// Where the target is at the end of the step, metres.
    pub at: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// Its velocity in the step, m/s.
    pub velocity: Vec3,
    /// Unused.
    pub _pad_b: u32,
}

/// Bytes from one step's uniform to the next's: a multiple of every adapter's alignment.
const STRIDE: u32 = 256;

/// One groom's hand.
#[derive(Debug, Default)]
pub struct Grab {
    /// The ray of the grab and its radius, while it lasts.
    ray: Option<(Ray, f32)>,
    target: Option<Target>,
    /// Whether the ray has still to be sent out.
    fresh: bool,
    /// Whether it is in this frame.
    picks: bool,
    pub(super) buffers: Option<Buffers>,
    /// Strand vertices, guide vertices.
    threads: [u32; 2],
}

/// What it needs on the GPU.
#[derive(Debug)]
pub(super) struct Buffers {
    pipelines: Arc<Pipelines>,
    uniforms: wgpu::Buffer,
    marks: wgpu::Buffer,
    state: wgpu::Buffer,
    holds: wgpu::Buffer,
    groups: kernels::Groups,
}

fn unit(ray: &Ray) -> Result<Ray> {
    let direction = ray.direction.normalize_or_zero();
    if !(ray.origin.is_finite() && direction.is_normalized()) {
        return Err(Error::Parameter {
            name: "a ray",
            value: format!("{ray:?}"),
            range: "finite, with a direction",
        });
    }
    Ok(Ray { origin: ray.origin, direction })
}

impl Grab {
    /// Grabs what `ray` meets and all guide vertices within `radius` metres of there. It happens when the
    /// next step is due; the hair as it was drawn last counts.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a ray without a direction, and a radius that is not from 1 mm to 1 m.
    pub fn begin(&mut self, ray: &Ray, radius: f32) -> Result<()> {
        Error::unless_within("grab radius", radius, 1e-3, 1.0, "from 0.001 to 1 m")?;
        let ray = unit(ray)?;
        self.ray = Some((ray, radius));
        self.target = Some(Target::Ray(ray));
        self.fresh = true;
        Ok(())
    }

    /// The hand moves; nothing without a grab.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what is not finite.
    pub fn drag(&mut self, target: &Target) -> Result<()> {
        let target = match target {
            Target::Ray(ray) => Target::Ray(unit(ray)?),
            Target::Point(point) if point.is_finite() => Target::Point(*point),
            Target::Point(point) => {
                return Err(Error::Parameter { name: "a target", value: point.to_string(), range: "finite" });
            }
        };
        if self.ray.is_some() {
            self.target = Some(target);
        }
        Ok(())
    }

    /// Lets go.
    pub fn end(&mut self) {
        (self.ray, self.target, self.fresh, self.picks) = (None, None, false, false);
    }

    /// Whether it holds, or tries to.
    pub fn is_active(&self) -> bool {
        self.ray.is_some()
    }

    /// [`GrabState`], one, once there has been a grab.
    pub fn state(&self) -> Option<&wgpu::Buffer> {
        self.buffers.as_ref().map(|buffers| &buffers.state)
    }

    /// What the hair's strands are in is other buffers from here on: it lets go.
    pub(crate) fn forget_buffers(&mut self) {
        self.buffers = None;
        self.end();
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffers.as_ref().map_or(0, |b| {
            [&b.uniforms, &b.marks, &b.state, &b.holds].iter().map(|buffer| buffer.size()).sum()
        })
    }

    /// Writes what the `steps` of a frame read; whether any of them pulls. `forced` when others have written
    /// [`GuideBuffers::forces`].
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn prepare(
        &mut self,
        context: &Context,
        physics: &SimulationParams,
        steps: &[Step],
        (guides, strands): (&GuideBuffers, &StrandBuffers),
        sights: &Sights,
        forced: bool,
    ) -> Result<bool> {
        let Context { queue, .. } = context;
        if steps.iter().any(|step| step.mode != Mode::Step) {
            self.end();
        }
        let (Some((ray, radius)), Some(target)) = (self.ray, self.target) else { return Ok(false) };
        let steps = &steps[steps.len().saturating_sub(MAX_STEPS as usize)..];
        self.picks = self.fresh && !steps.is_empty();
        if steps.is_empty() {
            return Ok(false);
        }
        self.fresh = false;
        if self.buffers.is_none() {
            self.buffers = Some(Buffers::new(context, guides, strands)?);
        }
        let Some(buffers) = &self.buffers else { return Ok(false) };
        let (target, toward) = match target {
            Target::Ray(ray) => (ray.origin, ray.direction),
            Target::Point(point) => (point, Vec3::ZERO),
        };
        let (seen, drawn) = (ray, sights.to_last.ray(&ray));
        let ray = sights.to_carrier.ray(&ray);
        let (target, toward) = (sights.to_carrier.at(target), sights.to_carrier.turned(toward));
        let substeps = physics.substeps.clamp(1, MAX_SUBSTEPS);
        let mut bytes = vec![0u8; STRIDE as usize * steps.len()];
        for (i, (step, slot)) in steps.iter().zip(bytes.chunks_mut(STRIDE as usize)).enumerate() {
            let uniform = GrabUniform {
                origin: ray.origin,
                radius,
                direction: ray.direction,
                share: ((step.to - step.from) / (1.0 - step.from).max(1e-6)).clamp(0.0, 1.0),
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
                aside: ASIDE,
                strongest: STRONGEST,
                seen_origin: seen.origin,
                seen_direction: seen.direction,
                drawn_origin: drawn.origin,
                drawn_direction: drawn.direction,
                // What is met in this step is met where it is then.
                shift: if i == 0 && !self.picks { sights.shift } else { Vec3::ZERO },
                ..Zeroable::zeroed()
            };
            slot[..size_of::<GrabUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        queue.write_buffer(&buffers.uniforms, 0, &bytes);
        if self.picks {
            queue.write_buffer(&buffers.marks, 0, bytemuck::cast_slice(&[u32::MAX; 2]));
        }
        self.threads = [strands.drawn.count * strands.drawn.vertex_count, guides.count * guides.vertex_count];
        Ok(true)
    }

    /// Records step `i` of those that [`prepare`](Self::prepare) wrote: after other forces, before the step.
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
                self.picks && i == 0,
            );
        }
    }
}

impl Buffers {
    fn new(context: &Context, guides: &GuideBuffers, strands: &StrandBuffers) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let kernels = &pipelines.grab;
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("grab"),
            size: u64::from(STRIDE * MAX_STEPS),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let marks = storage::<u32>(device, "grab marks", 4)?;
        let state = storage::<GrabState>(device, "grab state", 1)?;
        let holds = storage::<[f32; 4]>(
            device,
            "grab holds",
            u64::from(guides.count) * u64::from(guides.vertex_count),
        )?;
        let groups = kernels.bind([&uniforms, &marks, &state, &holds], guides, strands);
        Ok(Self { pipelines, uniforms, marks, state, holds, groups })
    }
}
