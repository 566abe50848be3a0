//! Guide simulation. One fixed step is one dispatch; one thread simulates one guide, whose state lies in workgroup
//! memory on a GPU and in private memory on a software driver (`step.rs`).
//!
//! A guide is a chain of point masses with springs along its edges, bending springs towards its rest shape, a weak
//! spring to its rest pose, drag, gravity and contacts. Each substep predicts `y = x + h v`, linearizes all forces
//! there and solves the implicit Euler equations of the whole strand at once. The system is symmetric, of 3×3 blocks
//! with two off-diagonals. It is eliminated from root to tip and substituted back.
//!
//! ```text
//! info, rest        ─► ┌ root to tip: predict, carry the frames     ┐
//! current, velocity ─► │ collider by collider: contacts             │ × substeps ─► current, velocity
//! forces            ─► │ tip to root: twist passed up by the bends  │
//! colliders         ─► │ root to tip: assemble, eliminate           │
//!                      └ tip to root: substitute                    ┘
//! ```
//!
//! **Bending.** The target of the edge after vertex `j` is `t = R c`. `R` rotates the edge before it from rest to the
//! current state: the head's rotation at the root, then minimal rotations from edge to edge. `c` is the rest edge plus
//! its gravity compensation. The force is the exact derivative of `½ k |e − t|²`, including the dependence of `t` on
//! all edges above it: a bend twists the hair above, and without that torque curls gain energy spontaneously. The
//! torque has no cheap stiffness matrix. Instead the solve adds damping proportional to the curl. It slows tight stiff
//! curls a little and vanishes in equilibrium.
//!
//! **Twist.** By default frames do not turn about their edges, as if torsional stiffness were infinite. With
//! [`SimulationParams::twist`] hair is an elastic rod (`twist.wesl`). Each bend has an angle `φ`, by which the frame
//! after it is turned against a minimal rotation of the frame before it, and the energy `½ c φ²`. One solve with 4×4
//! blocks has positions and edge turns as unknowns. A frame's turn as a function of positions is a sum over the whole
//! strand, but its turn relative to the previous step is not. With these turns as unknowns, a bend depends on its own
//! vertices and the turn of one edge, and a twist on its own vertices and two turns (time-parallel frames, Bergou and
//! others, "Discrete viscous threads", 2010). Everything is implicit, so tight curls need no stiffness limit and no
//! damping in place of a torque. Bends are measured about the edge after a vertex, which makes no difference for
//! bending alone. Where twist is stiffer or softer than bending, the difference acts about the tangent at the vertex;
//! otherwise helical springs of eight vertices per turn would be wrong by a tenth. Bends that carry weight twist the
//! rest pose; that twist is computed from the pose. Updating the angles after each solve of positions, which would keep
//! 3×3 blocks, was tried: soft springs then creep, and stiff ones gain energy.
//!
//! **Why not a workgroup per guide with iterated constraints?** Iterations preserve neither lengths nor stiffness:
//! after 20 of them a strand of 16 vertices is a rubber band, and its stiffness depends on their number. A direct solve
//! preserves both (cantilever within 1 %, strain below 1 % in a 2 Hz shake; `docs/validation/motion.md` has the table)
//! with fewer operations. Elimination is serial along the strand, so 63 of 64 threads would wait at barriers. A
//! thousand guides fill a GPU as well as a thousand groups.
//!
//! **Lengths.** The edge springs leave less than 1 % of strain in a shake. In a shock of 20 g a slack chain folds
//! within a substep and single edges are compressed by up to 82 %. Therefore every edge outside ±0.8 % is brought back
//! to that limit, root to tip, before the next solve.
//!
//! **Contacts** are springs normal to a surface, a hundred times as stiff as a vertex's inertia in a substep. Friction
//! is a tangential spring. Its stiffness is Coulomb's limit divided by the slip of the last substep, at most a thousand
//! times the contact stiffness. A vertex pulled with less than the limit sticks, but for a creep of micrometers per
//! second; a vertex that slips is braked by exactly the limit. No iteration decides between the two. The slip comes
//! from velocities, because hair at rest slips by less than the rounding of positions. A vertex that was in contact and
//! has barely left stays in contact for one more substep. Otherwise hair at rest would touch in every second substep
//! and slide in the others. The cost is a slow onset of slip: 1 % above the critical slope it takes seconds to become
//! visible.
//!
//! **Rounding.** A strand is thousands of times stiffer along an edge than across it. Blocks are therefore factored
//! (`math/ldl.wesl`), not inverted. In four steps of a turning head, rounding moves vertices by 0.01 mm (16 vertices),
//! 0.1 mm (32) and 2 mm (64), and those of a strand with a segment of zero length by millimeters: the direction of that
//! segment is rounding error.
//!
//! **State.** 40 bytes per vertex, 48 with twist. The rest state takes 16 (`PackedGuide`: position as 16-bit fractions
//! of the guide's cube, contact, and the deviation of bends and edges from the rest pose). The position takes 12 and
//! the velocity 8 (19-bit fractions with one exponent). Another 4 hold the difference between the previous position and
//! the one that position and velocity predict. The rest shape is computed from the rounded pose, so rounding moves the
//! pose by micrometers (`extent / 131070`) and bends nothing. Velocities have a relative error of at most 2⁻¹⁸, which
//! over a step is less than the rounding of positions.
//!
//! **Speed.** On a CPU driver (Mesa's lavapipe, two cores) a step of 11,400 guides with 16 vertices takes 105 ms of
//! processor time. A fifth of it is contacts and another tenth their distance field. A third is traffic of private
//! arrays, which such a driver reads and writes lane by lane, and a tenth is waiting for memory. The driver runs a
//! loop's body until no lane is left, so a loop that tests first runs its body once too often. With the contacts of a
//! vertex in three nested loops of that kind, a step took 160 ms. Contacts are therefore a separate pass, collider by
//! collider: a collider's pose and shape are read once per strand instead of once per vertex. When the driver unrolled
//! the loops, a step was no faster and took seconds longer to compile, hence `params::StepUniforms::one`.
//!
//! **Known limits.** Elimination from tip to root would save a pass, but its rounding error is far larger. Positions
//! are single precision, relative to an origin near the hair that moves with the space of the frame's poses
//! ([`crate::space`]).

mod follow_leader;
mod forces;
pub mod grab;
pub mod links;
pub mod params;
pub mod rest;
pub mod shift;
mod step;
pub mod ties;

#[cfg(test)]
mod gpu_tests;

use crate::{
    Context, Result,
    clock::{MAX_STEPS, Mode, Step},
    collide::ColliderSet,
    constants::{STEP_BYTES, TWIST_BYTES},
    gpu::{BindBuffer, BufferBinding, Kernel, Opaque, PipelineSet, Uniform},
    shaders::kernels::simulate as kernels,
    space::Field,
    strands::GuideBuffers,
    wind::Wind,
};
use glam::Vec3;
use params::StepUniforms;
use std::sync::Arc;
use step::StepKernels;

pub(crate) use follow_leader::Tree;
pub(crate) use forces::Forces;
pub use grab::{BrushEffect, Grab, GrabTarget, MotionBrush};
pub(crate) use links::LinkAsset;
pub(crate) use links::Links;
pub use params::{RootToTip, SimulationParams};
pub(crate) use rest::GuideTraits;
pub use rest::{RestOptions, RestShape};
pub(crate) use shift::Shifting;
pub use ties::TieReport;
pub(crate) use ties::{TieAsset, Ties};

/// Stride between the uniforms of consecutive steps, bytes: a multiple of every adapter's alignment.
const STRIDE: u64 = 512;

/// The stage's pipelines.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) step: StepKernels,
    /// For hair with twist.
    pub(crate) twist: StepKernels,
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
        Self {
            step: StepKernels::new(context, "simulate::step", STEP_BYTES),
            twist: StepKernels::new(context, "simulate::twist", TWIST_BYTES),
            shift: shift::kernel(context),
            forces: forces::ForcesKernel::new(context),
            links: Kernel::new::<kernels::Links>(&context.device),
            grab: grab::GrabKernels::new(context),
            lead: follow_leader::kernel(context),
            ties: Kernel::new::<kernels::Ties>(&context.device),
            pins: Kernel::new::<kernels::Pins>(&context.device),
        }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.forces.kernel]
    }
}

/// One groom's simulation state on the GPU, besides its guides.
#[derive(Debug)]
pub(crate) struct Simulation {
    pipelines: Arc<Pipelines>,
    uniforms: Uniform,
    group: wgpu::BindGroup,
    guide_count: u32,
    vertex_count: u32,
    /// Motion of unsimulated guides; `None` until some guides are not simulated.
    lead: Option<follow_leader::Lead>,
    /// Bands, braids and pins.
    ties: Option<Ties>,
    /// Number of simulated guides: from the next frame on, and in each step of this frame.
    simulated: (u32, Vec<u32>),
    slip: f32,
    /// Whether the buffers have room for twist, and whether this frame simulates twist.
    twists: (bool, bool),
}

impl Simulation {
    /// Creates the simulation of `guides`.
    pub fn new(context: &Context, guides: &GuideBuffers) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let uniforms = device.storage_uniform((STRIDE * u64::from(MAX_STEPS)) as usize);
        let strand = kernels::Strand {
            given: slot(&uniforms),
            info: guides.info.entire(),
            rest: guides.rest.entire(),
            current: guides.current.entire(),
            velocity: guides.velocity.entire(),
            forces: guides.forces.entire(),
            roots: guides.roots.entire(),
        };
        let group = pipelines.step.of(guides.vertex_count).bind(&kernels::Step { strand });
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

    /// Limits simulation to the first `count` guides in the order of `tree`, from the next frame on. The others follow
    /// them.
    pub(crate) fn simulate_first(&mut self, guides: &GuideBuffers, tree: &Tree, count: u32) {
        self.lead.get_or_insert_with(|| {
            follow_leader::Lead::new(&self.pipelines.lead, slot(&self.uniforms), guides, tree)
        });
        self.simulated.0 = count.clamp(1, self.guide_count.max(1));
    }

    /// Replaces all ties, from the next frame on.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(crate) fn tie(
        &mut self,
        context: &Context,
        guides: &GuideBuffers,
        ties: Option<&TieAsset>,
    ) -> Result<()> {
        let step = slot(&self.uniforms);
        self.ties = ties.map(|ties| Ties::new(context, step, guides, ties)).transpose()?;
        Ok(())
    }

    /// Returns the bands, braids and pins, if there are any.
    pub fn ties(&self) -> Option<&Ties> {
        self.ties.as_ref()
    }

    /// Disables static friction from the next frame on: friction still brakes hair but no longer holds it, as while
    /// combing.
    pub(crate) fn slide(&mut self) {
        self.slip = 1e-6;
    }

    /// Simulates all guides from the next frame on.
    pub(crate) fn simulate_all(&mut self) {
        self.simulated.0 = self.guide_count;
    }

    /// Returns the number of simulated guides.
    pub fn simulated(&self) -> u32 {
        self.simulated.0
    }

    /// Bytes of GPU memory of this head alone, without the guides.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.uniforms.size() + self.ties.as_ref().map_or(0, Ties::own_bytes)
    }

    /// Records a frame's `steps` into `pass`, at most the last [`MAX_STEPS`]. The caller has
    /// [advanced](ColliderSet::advance) `colliders` by the same steps.
    ///
    /// # Errors
    /// The errors of [`SimulationParams::check`].
    pub fn run(
        &mut self,
        pass: &mut crate::gpu::ComputePass<'_>,
        params: &SimulationParams,
        steps: &[Step],
        colliders: &ColliderSet,
    ) -> Result<()> {
        let count = self.prepare(params, steps, false)?;
        for i in 0..count {
            self.record(pass, colliders, i);
        }
        Ok(())
    }

    /// Returns whether the last prepared frame simulates twist.
    pub(crate) fn twists(&self) -> bool {
        self.twists.1
    }

    /// Writes the uniforms of a frame's `steps`, at most the last [`MAX_STEPS`], and returns their number. With
    /// `forced`, the steps read [`GuideBuffers::forces`]; the caller records [`Forces::record`] before each.
    ///
    /// # Errors
    /// The errors of [`run`](Self::run).
    pub fn prepare(&mut self, params: &SimulationParams, steps: &[Step], forced: bool) -> Result<u32> {
        self.prepare_in(params, steps, &[], forced)
    }

    /// Like [`prepare`](Self::prepare), for hair simulated in a carrier frame: `fields` holds gravity and air for each
    /// step.
    pub(crate) fn prepare_in(
        &mut self,
        params: &SimulationParams,
        steps: &[Step],
        fields: &[Field],
        forced: bool,
    ) -> Result<u32> {
        params.check()?;
        self.twists.1 = self.twists.0 && params.twist > 0.0;
        let steps = &steps[steps.len().saturating_sub(MAX_STEPS as usize)..];
        if steps.is_empty() || self.guide_count == 0 {
            return Ok(0);
        }
        // `Rigid` and `Reset` steps move every guide.
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
                // Simulated air handles its own wind and rotation.
                let [wind, spin] = [field.wind, field.spin].map(|v| if uniform { v } else { Vec3::ZERO });
                uniforms = StepUniforms { gravity: field.gravity, wind, spin, ..uniforms };
            }
            slot[..size_of::<StepUniforms>()].copy_from_slice(bytemuck::bytes_of(&uniforms));
        }
        self.uniforms.write(0, &bytes);
        Ok(steps.len() as u32)
    }

    /// Records step `i` of those written by [`prepare`](Self::prepare).
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, colliders: &ColliderSet, i: u32) {
        pass.set_bind_group(1, colliders.group(), &[]);
        let simulated = self.simulated.1[i as usize];
        let offset = i * STRIDE as u32;
        if let Some(ties) = &self.ties {
            ties.record(pass, offset);
        }
        let kernels = if self.twists.1 { &self.pipelines.twist } else { &self.pipelines.step };
        kernels.record(pass, &self.group, offset, [simulated, self.vertex_count]);
        if let Some(lead) = self.lead.as_ref().filter(|_| simulated < self.guide_count) {
            lead.record(&self.pipelines.lead, pass, offset, [simulated, self.guide_count]);
        }
    }

    /// Returns the uniforms of the frame's `i`th step.
    fn uniforms(&self, params: &SimulationParams, step: &Step, i: u32) -> StepUniforms {
        let (count, n) = (self.guide_count, self.vertex_count);
        let uniforms = StepUniforms::new(params, count, n, step.mode, &step.begin, &step.end);
        StepUniforms { moment: i * uniforms.substeps, ..uniforms }
    }
}

/// Binding of one step's uniforms.
fn slot(uniforms: &Uniform) -> BufferBinding<'_, Opaque> {
    uniforms.part(0, Some(size_of::<StepUniforms>() as u64))
}
