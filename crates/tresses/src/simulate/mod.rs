//! The motion of the guides: one fixed step is one dispatch, one thread simulates one guide.
//!
//! A guide is a chain of point masses with springs along its edges, bending springs towards its rest shape,
//! a weak pull to its rest pose, drag, gravity and contacts. Each substep predicts `y = x + h v`,
//! linearises all forces there and solves the implicit Euler equations of the whole strand at once: a
//! symmetric system of 3×3 blocks with two off-diagonals, eliminated from root to tip and substituted back.
//!
//! ```text
//! info, rest        ─► ┌ root to tip: predict, carry the frames     ┐
//! current, velocity ─► │ collider by collider: contacts             │ × substeps ─► current, velocity
//! forces            ─► │ tip to root: twist passed up by the bends  │
//! colliders         ─► │ root to tip: assemble, eliminate           │
//!                      └ tip to root: substitute                    ┘
//! ```
//!
//! **Bending.** The target of the edge after vertex `j` is `t = R c`, where `R` is the rotation from rest
//! to the current state of the edge before it (the head's at the root, then minimal rotations from edge to
//! edge) and `c` the rest edge plus its compensation of gravity. The force is the exact derivative of
//! `½ k |e − t|²`, including how `t` follows all edges above it: a bend twists the hair above, and without
//! that torque curls gain energy spontaneously. The torque has no cheap stiffness matrix; instead there is
//! damping proportional to the curl, which slows tight stiff curls a little and vanishes in equilibrium.
//!
//! **Twist.** By default frames do not turn about their edges, as if hair were endlessly stiff against it. With
//! [`SimulationParams::twist`] hair is an elastic rod (`twist.wesl`): each bend has an angle by which the frame after it is
//! turned against a minimal rotation of the frame before, and `½ c φ²` for it. Angles and positions are unknowns of one solve,
//! blocks of 4×4: how a frame turns when positions are given is a sum over the whole strand, but the turn of a frame against
//! itself in the step before is not, and with these turns as unknowns, instead of the angles, a bend knows its own vertices
//! and the turn of one edge, a twist its own vertices and two turns (as time-parallel frames do in Bergou and others,
//! "Discrete viscous threads", 2010). All of it is implicit, hence no limit for tight curls and no damping in place of a
//! torque. Bends are taken about the edge after a vertex, which for bending alone makes no difference; where twist is
//! stiffer or softer, what differs lies about the tangent at the vertex, or springs of eight vertices a turn would err by a
//! tenth. The twist that the rest pose has because its bends carry weight is computed from that pose. Angles updated after
//! each solve of positions, which would leave that as it is, were tried: soft springs then creep, stiff ones gain energy.
//!
//! **Why not a workgroup per guide with iterated constraints?** Iterations preserve neither lengths nor
//! stiffness: with 20 of them a strand of 16 vertices is a rubber band, and its stiffness depends on their
//! number. A direct solve preserves both (cantilever within 1 %, strain below 1 % in a 2 Hz shake;
//! `docs/physics.md` has the table) with fewer operations, and elimination is serial along the strand, so
//! 63 of 64 threads would wait at barriers. A thousand guides fill a GPU as well as a thousand groups.
//!
//! **Lengths.** The springs along the edges leave less than 1 % of strain in a shake. In a shock of 20 g a
//! slack chain folds within a substep and single edges are compressed by up to 82 %, so every edge outside
//! ±0.8 % is brought back to that limit, root to tip, before the next solve.
//!
//! **Contacts** are springs across a surface, a hundred times as stiff as a vertex's inertia in a substep. Friction along it
//! is as stiff as Coulomb's force allows at the way that the vertex slipped in the last substep, at most a thousand times
//! as stiff as the contact: what is pulled by less than that force sticks but for micrometres per second, what slips is
//! braked by just that force, and no sum over iterations decides which. The slip is taken from velocities, as that of
//! hair at rest is less than the rounding of positions. A vertex that was in contact and is hardly out stays in it for a
//! substep, else hair at rest would touch in every second substep and slide in the others. In exchange slip begins
//! slowly: 1 % above the critical slope it takes seconds until it shows.
//!
//! **Rounding.** A strand is thousands of times stiffer along an edge than across it. The blocks are
//! therefore factored (see [`crate::math::ldl`]), not inverted. Kernel and scalar twin differ by 0.01 mm
//! (16 vertices) to 0.1 mm (32) and 2 mm (64) in four steps of a turning head. Only a strand with a segment
//! of zero length differs by millimetres: the direction of that segment is rounding error.
//!
//! **State.** 40 bytes per vertex, 8 more where it can twist: what rests in 16 (`PackedGuide`: the position as 16-bit fractions of the guide's
//! cube, contact, and how bends and edges differ from the rest pose), the position in 12, the velocity in 8 (19-bit
//! fractions with one exponent), and in 4 how far the position before the step was from where position and velocity
//! say. The rest shape is computed from the rounded pose, so rounding moves the pose by micrometres (`extent / 131070`)
//! and bends nothing. Velocities err by 2⁻¹⁹, which in a step is less than the rounding of positions.
//!
//! **Speed.** On a CPU driver (Mesa's lavapipe, two cores) a step of 11,400 guides with 16 vertices takes 105 ms of
//! processor time: a fifth of it contacts and another tenth their distance field, a third the traffic of private
//! arrays, which such a driver reads and writes lane by lane, a tenth waiting for memory. Its loops run their body
//! until no lane is left, so that one that tests first runs it once too often; with the contacts of a vertex in
//! three nested loops, each of them such, a step took 160 ms. Contacts are therefore a pass of their own, collider by
//! collider: the place and shape of one are read once per strand instead of once per vertex. Unrolled by the driver a
//! step took no less time and seconds more to compile, hence [`params::StepUniforms::one`].
//!
//! **Known limits.** Elimination from tip to root would save a pass, but its rounding error is far larger.
//! Positions are single precision from an origin near the hair, which goes along with the space of the frame's poses
//! ([`crate::space`]).

mod forces;
pub mod grab;
mod lead;
pub mod links;
pub mod params;
pub mod rest;
pub mod shift;
mod step;
pub mod ties;

#[cfg(test)]
mod gpu_tests;
#[cfg(test)]
mod physics;
#[cfg(test)]
mod reference;

use crate::{
    Context, Result,
    clock::{MAX_STEPS, Mode, Step},
    collide::{self, ColliderSet},
    constants::{GUIDE_CAPACITIES, GUIDE_WORKGROUP},
    gpu::{Kernel, PipelineSet},
    groom::Guides,
    space::Field,
    strands::GuideBuffers,
    wind::Wind,
};
use glam::Vec3;
use params::StepUniforms;
use std::sync::Arc;

pub use forces::{AirUniforms, Forces};
pub use grab::{Grab, Target};
pub(crate) use lead::Tree;
pub use links::Links;
pub use params::{Along, SimulationParams};
pub use rest::{GuideTraits, RestOptions, RestShape};
pub(crate) use shift::Shifting;
pub use ties::{Held, Tie, TieReport, Ties};

/// Bytes from one step's uniforms to the next's: a multiple of every adapter's alignment.
const STRIDE: u64 = 512;

/// The pipelines of the stage.
#[derive(Debug)]
pub(crate) struct Pipelines {
    /// One per size class of guides.
    steps: [Kernel; GUIDE_CAPACITIES.len()],
    /// The same for hair that twists.
    twists: [Kernel; GUIDE_CAPACITIES.len()],
    shift: Kernel,
    pub(crate) forces: forces::ForcesKernel,
    pub(crate) links: Kernel,
    pub(crate) grab: grab::GrabKernels,
    lead: Kernel,
    ties: Kernel,
    pins: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let colliders = collide::layout(device);
        let kernel = |name| Kernel::beside(&context.device, name, &step::BINDINGS, &[&colliders]);
        Self {
            steps: step::MODULES.map(kernel),
            twists: step::TWIST_MODULES.map(kernel),
            shift: shift::kernel(context),
            forces: forces::ForcesKernel::new(context),
            links: Kernel::new(&context.device, "simulate::links", &links::BINDINGS),
            grab: grab::GrabKernels::new(context),
            lead: lead::kernel(context),
            ties: Kernel::new(&context.device, "simulate::ties", &ties::BINDINGS),
            pins: Kernel::new(&context.device, "simulate::pins", &ties::PIN_BINDINGS),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.forces.kernel]
    }
}

impl Pipelines {
    /// The step for guides of `vertex_count` vertices.
    pub(crate) fn step(&self, vertex_count: u32) -> &Kernel {
        &self.steps[step::capacity(vertex_count)]
    }

    /// The same for hair that twists.
    pub(crate) fn twist(&self, vertex_count: u32) -> &Kernel {
        &self.twists[step::capacity(vertex_count)]
    }
}

/// What one groom's simulation keeps on the GPU besides its guides.
#[derive(Debug)]
pub struct Simulation {
    pipelines: Arc<Pipelines>,
    uniforms: wgpu::Buffer,
    group: wgpu::BindGroup,
    guide_count: u32,
    vertex_count: u32,
    /// What leads guides that are not simulated, once some are not.
    lead: Option<lead::Lead>,
    /// What holds guides together or to the head.
    ties: Option<Ties>,
    /// How many are simulated from the next frame on, and in each step of this one.
    simulated: (u32, Vec<u32>),
    slip: f32,
    /// Whether there is room for twist, and whether hair twists in this frame.
    twists: (bool, bool),
}

impl Simulation {
    /// The simulation of `guides`.
    pub fn new(context: &Context, guides: &GuideBuffers) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("simulation steps"),
            size: STRIDE * u64::from(MAX_STEPS),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let step = slot(&uniforms);
        let group = pipelines.step(guides.vertex_count).bind(&[
            step,
            guides.info.as_entire_binding(),
            guides.rest.as_entire_binding(),
            guides.current.as_entire_binding(),
            guides.velocity.as_entire_binding(),
            guides.forces.as_entire_binding(),
            guides.roots.as_entire_binding(),
        ]);
        Self {
            pipelines,
            uniforms,
            group,
            guide_count: guides.count,
            vertex_count: guides.vertex_count,
            lead: None,
            ties: None,
            simulated: (guides.count, Vec::new()),
            slip: 0.0,
            twists: (guides.can_twist(), false),
        }
    }

    /// From the next frame on only the first `count` guides in the order of `tree` are simulated, which others follow.
    pub(crate) fn simulate_first(&mut self, guides: &GuideBuffers, tree: &Tree, count: u32) {
        self.lead
            .get_or_insert_with(|| lead::Lead::new(&self.pipelines.lead, slot(&self.uniforms), guides, tree));
        self.simulated.0 = count.clamp(1, self.guide_count.max(1));
    }

    /// From the next frame on `ties` hold the guides, which rest as `rest` says, instead of those that did; without any, none.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a tie that makes no sense, [`crate::groom::Error::Unusable`] for one that holds
    /// nothing and for more than [`ties::MAX_RINGS`]; [`crate::Error::Limit`].
    pub fn tie(
        &mut self,
        context: &Context,
        guides: &GuideBuffers,
        rest: &Guides,
        ties: &[Tie],
    ) -> Result<TieReport> {
        let step = &slot(&self.uniforms);
        let make = || Ties::new(context, step, guides, rest, ties);
        self.ties = (!ties.is_empty()).then(make).transpose()?;
        Ok(self.ties.as_ref().map(Ties::report).unwrap_or_default())
    }

    /// From the next frame on what holds the guides of `other`, of the same groom, holds these.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(crate) fn tie_as(&mut self, context: &Context, guides: &GuideBuffers, other: &Self) -> Result<()> {
        let step = &slot(&self.uniforms);
        self.ties = other.ties.as_ref().map(|ties| ties.another(context, step, guides)).transpose()?;
        Ok(())
    }

    /// What holds guides together or to the head.
    pub fn ties(&self) -> Option<&Ties> {
        self.ties.as_ref()
    }

    /// From the next frame on friction brakes, but does not hold: what is pulled slides on, as hair does that is combed.
    pub(crate) fn slide(&mut self) {
        self.slip = 1e-6;
    }

    /// From the next frame on all guides are simulated.
    pub(crate) fn simulate_all(&mut self) {
        self.simulated.0 = self.guide_count;
    }

    /// How many guides are.
    pub fn simulated(&self) -> u32 {
        self.simulated.0
    }

    /// Bytes of GPU memory, without the guides.
    pub fn bytes(&self) -> u64 {
        self.uniforms.size() + self.ties.as_ref().map_or(0, Ties::bytes)
    }

    /// Records the `steps` of a frame into `pass`, at most [`MAX_STEPS`]; with none, nothing.
    /// `colliders` have been [advanced](ColliderSet::advance) by the same steps.
    ///
    /// # Errors
    /// What [`SimulationParams::check`] says.
    pub fn run(
        &mut self,
        context: &Context,
        pass: &mut crate::gpu::ComputePass<'_>,
        params: &SimulationParams,
        steps: &[Step],
        colliders: &ColliderSet,
    ) -> Result<()> {
        let count = self.prepare(context, params, steps, false)?;
        for i in 0..count {
            self.record(pass, colliders, i);
        }
        Ok(())
    }

    /// Whether hair twists, since the last step.
    pub(crate) fn twists(&self) -> bool {
        self.twists.1
    }

    /// Writes the uniforms of a frame's `steps`, at most [`MAX_STEPS`], and returns how many there
    /// are. With `forced`, [`GuideBuffers::forces`] act in
    /// them: [`Forces::record`] belongs before each.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn prepare(
        &mut self,
        context: &Context,
        params: &SimulationParams,
        steps: &[Step],
        forced: bool,
    ) -> Result<u32> {
        self.prepare_in(context, params, steps, &[], forced)
    }

    /// The same where hair is simulated elsewhere than in the world: `fields` say what acts in each step.
    pub(crate) fn prepare_in(
        &mut self,
        context: &Context,
        params: &SimulationParams,
        steps: &[Step],
        fields: &[Field],
        forced: bool,
    ) -> Result<u32> {
        let Context { queue, .. } = context;
        params.check()?;
        self.twists.1 = self.twists.0 && params.twist > 0.0;
        let steps = &steps[steps.len().saturating_sub(MAX_STEPS as usize)..];
        if steps.is_empty() || self.guide_count == 0 {
            return Ok(0);
        }
        // What puts guides elsewhere knows all of them.
        let (some, all) = (self.simulated.0, self.guide_count);
        self.simulated.1 =
            steps.iter().map(|step| if step.mode == Mode::Step { some } else { all }).collect();
        let mut bytes = vec![0u8; STRIDE as usize * steps.len()];
        let slots = bytes.as_chunks_mut::<{ STRIDE as usize }>().0;
        for (i, (step, slot)) in steps.iter().zip(slots).enumerate() {
            let mut uniforms = StepUniforms {
                forced: forced.into(),
                to: step.to,
                slip: self.slip,
                simulated: self.simulated.1[i],
                ..self.uniforms(params, step, i as u32)
            };
            if let Some(field) = fields.get(i) {
                let uniform = !Wind { velocity: field.wind, ..params.wind }.blows();
                // Where the air is a fluid, that turns or does not.
                let [wind, spin] = [field.wind, field.spin].map(|v| if uniform { v } else { Vec3::ZERO });
                uniforms = StepUniforms { gravity: field.gravity, wind, spin, ..uniforms };
            }
            slot[..size_of::<StepUniforms>()].copy_from_slice(bytemuck::bytes_of(&uniforms));
        }
        queue.write_buffer(&self.uniforms, 0, &bytes);
        Ok(steps.len() as u32)
    }

    /// Records step `i` of those that [`prepare`](Self::prepare) wrote.
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, colliders: &ColliderSet, i: u32) {
        pass.set_bind_group(1, colliders.group(), &[]);
        let simulated = self.simulated.1[i as usize];
        let offset = i * STRIDE as u32;
        let groups = simulated.div_ceil(GUIDE_WORKGROUP);
        if let Some(ties) = &self.ties {
            ties.record(pass, offset);
        }
        let twists = self.twists.1;
        let kernel = if twists {
            self.pipelines.twist(self.vertex_count)
        } else {
            self.pipelines.step(self.vertex_count)
        };
        kernel.record(pass, &self.group, &[offset], groups);
        if let Some(lead) = self.lead.as_ref().filter(|_| simulated < self.guide_count) {
            lead.record(&self.pipelines.lead, pass, offset, [simulated, self.guide_count]);
        }
    }

    /// The uniforms of the frame's `i`th step.
    fn uniforms(&self, params: &SimulationParams, step: &Step, i: u32) -> StepUniforms {
        let (count, n) = (self.guide_count, self.vertex_count);
        let uniforms = StepUniforms::new(params, count, n, step.mode, &step.begin, &step.end);
        StepUniforms { moment: i * uniforms.substeps, ..uniforms }
    }
}

/// One step's uniforms.
fn slot(uniforms: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer: uniforms,
        offset: 0,
        size: wgpu::BufferSize::new(size_of::<StepUniforms>() as u64),
    })
}
