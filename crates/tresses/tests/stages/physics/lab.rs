//! Experiments with strands on the GPU and a head that moves them.

use crate::common;
use std::{cell::Cell, sync::OnceLock};
use tresses::{
    Context, Pose, RestOptions, RestShape, RootToTip, SimulationParams,
    clock::{Mode, Step, StepClock},
    collide::{ColliderDescriptor, ColliderPoses, ColliderSet, Moments},
    glam::Vec3,
    groom::SdfGrid,
    low_level::{GuideBuffers, MAX_STEPS, Tier, readback::blocking as readback, unpack_velocity},
    simulate::{GuideTraits, Simulation, rest},
    strands::{RestGuides, guide::pack_velocity},
};

/// The device and pipelines that all cases share.
pub struct Lab {
    pub context: &'static Context,
}

thread_local! {
    /// Whether this thread's experiments use the kernels for GPUs, whatever the device is.
    static FOR_GPUS: Cell<bool> = const { Cell::new(false) };
}

/// Creates a context with the kernels for GPUs, instead of those for software adapters, on this thread's device.
fn with_kernels_for_gpus() -> Option<Context> {
    let context = common::context()?;
    Some(context.clone().with_tier(Tier { software: false, ..context.tier() }))
}

/// Returns the lab, or `None` if there is no adapter and none is required.
pub fn lab() -> Option<&'static Lab> {
    static LABS: tresses_testing::Pool<Lab> = tresses_testing::Pool::new();
    static LABS_FOR_GPUS: tresses_testing::Pool<(Context, OnceLock<Lab>)> = tresses_testing::Pool::new();
    if !FOR_GPUS.get() {
        return LABS.get(|| Some(Lab { context: common::context()? }));
    }
    let (context, lab) = LABS_FOR_GPUS.get(|| Some((with_kernels_for_gpus()?, OnceLock::new())))?;
    Some(lab.get_or_init(|| Lab { context }))
}

/// Runs tests with the kernels that GPUs use.
pub fn for_gpus(tests: &[fn()]) {
    FOR_GPUS.set(true);
    tests.iter().for_each(|test| test());
    FOR_GPUS.set(false);
}

/// Returns hair with one bending stiffness (N·m²) and nothing else: no goal, no drag, no damping.
pub fn bare(bending: f32) -> SimulationParams {
    let uniform = |value| RootToTip { root: value, tip: value, falloff: 1.0 };
    SimulationParams {
        bending: uniform(bending),
        goal: uniform(0.0),
        bending_damping: 0.0,
        drag: 0.0,
        friction: 0.0,
        ..Default::default()
    }
}

/// Returns a straight strand of `n` vertices. Its free part, from vertex 1 on, starts at the origin and is `length`
/// meters long.
pub fn straight(n: usize, length: f32, dir: Vec3) -> Vec<Vec3> {
    let edge = length / (n - 2) as f32;
    (0..n).map(|i| dir * edge * (i as f32 - 1.0)).collect()
}

/// Strands with equal numbers of vertices.
pub struct Experiment {
    lab: &'static Lab,
    pub params: SimulationParams,
    pub rest: RestGuides,
    /// Vertices per strand.
    pub vertex_count: usize,
    /// Poses of the colliders of [`with_colliders`](Self::with_colliders).
    pub obstacles: ColliderPoses,
    guides: GuideBuffers,
    colliders: ColliderSet,
    simulation: Simulation,
    clock: StepClock,
}

impl Experiment {
    /// Creates strands that start in their rest shape. `field` is the distance field of the head.
    pub fn new(
        lab: &'static Lab,
        strands: &[Vec<Vec3>],
        traits: &[GuideTraits],
        params: SimulationParams,
        shape: RestShape,
        field: Option<&SdfGrid>,
    ) -> Self {
        let vertex_count = strands[0].len();
        let options = RestOptions { shape, ..Default::default() };
        let rest =
            rest::guides(&strands.concat(), vertex_count as u32, traits, &params, &options, field).unwrap();
        let context = lab.context;
        let mut guides = GuideBuffers::new(context, strands.len() as u32, vertex_count as u32, 2).unwrap();
        if params.twist > 0.0 {
            guides.add_twist(context).unwrap();
        }
        rest.upload(context, &guides).unwrap();
        let descriptor = ColliderDescriptor { head: field, ..Default::default() };
        let colliders = ColliderSet::new(context, &descriptor).unwrap();
        let simulation = Simulation::new(context, &guides);
        let (obstacles, clock) = (ColliderPoses::default(), StepClock::default());
        Self { colliders, lab, params, rest, vertex_count, obstacles, guides, simulation, clock }
    }

    /// Replaces the head's field by the colliders of `descriptor`, with the poses `poses`.
    pub fn with_colliders(mut self, descriptor: &ColliderDescriptor<'_>, poses: Vec<Pose>) -> Self {
        let context = self.lab.context;
        self.colliders = ColliderSet::new(context, descriptor).unwrap();
        self.obstacles.colliders = poses;
        self
    }

    /// Returns the number of strands.
    pub fn count(&self) -> usize {
        self.rest.info.len()
    }

    /// Runs fixed steps, in batches of at most [`MAX_STEPS`].
    pub fn run_steps(&mut self, steps: &[Step]) {
        let context = self.lab.context;
        for steps in steps.chunks(MAX_STEPS as usize) {
            let (substeps, head) = (self.params.substep_count, steps[steps.len() - 1].end);
            let moments = Moments { steps, substeps, step: self.params.step, head, alpha: 1.0 };
            self.colliders.advance(&self.obstacles, &moments).unwrap();
            common::compute(context, |pass| {
                self.simulation.run(pass, &self.params, steps, &self.colliders).unwrap();
            });
        }
    }

    /// Runs `count` steps with a still head.
    pub fn run_still(&mut self, count: usize) {
        self.run_steps(&vec![step(Pose::IDENTITY, Pose::IDENTITY); count]);
    }

    /// Runs `seconds` in fixed steps. `motion` gives the head's pose at each time.
    pub fn run_motion(&mut self, seconds: f32, motion: impl Fn(f32) -> Pose) {
        let count = (seconds / self.params.step).round() as usize;
        let at = |i: usize| motion(i as f32 * self.params.step);
        let steps: Vec<_> = (0..count).map(|i| step(at(i), at(i + 1))).collect();
        self.run_steps(&steps);
    }

    /// Advances by a frame: runs the steps that are due `dt` seconds after the last frame, with the head now at `head`.
    pub fn frame(&mut self, dt: f32, head: Pose) {
        let ticks = self.clock.tick(dt, self.params.step, &head);
        self.run_steps(&ticks.steps);
    }

    /// Returns the positions of the vertices by strand, meters.
    pub fn positions(&self) -> Vec<Vec<Vec3>> {
        self.read(&self.guides.current, |v: &[f32; 4]| Vec3::from_slice(v))
    }

    /// Returns the velocities of the vertices by strand, m/s.
    pub fn velocities(&self) -> Vec<Vec<Vec3>> {
        self.read(&self.guides.velocity, |v| unpack_velocity(*v))
    }

    fn read<T: bytemuck::Pod>(
        &self,
        buffer: &tresses::wgpu::Buffer,
        unpack: impl Fn(&T) -> Vec3,
    ) -> Vec<Vec<Vec3>> {
        let context = self.lab.context;
        let all: Vec<T> = readback::buffer(context, buffer).unwrap();
        let count = self.count();
        (0..count)
            .map(|strand| (0..self.vertex_count).map(|i| unpack(&all[i * count + strand])).collect())
            .collect()
    }

    /// Sets the positions of the vertices by strand, meters.
    pub fn set_positions(&self, positions: &[Vec<Vec3>]) {
        self.write(&self.guides.current, positions, |p| p.extend(0.0).to_array().map(f32::to_bits));
    }

    /// Sets the velocities of the vertices by strand, m/s.
    pub fn set_velocities(&self, velocities: &[Vec<Vec3>]) {
        self.write(&self.guides.velocity, velocities, pack_velocity);
    }

    fn write<const N: usize>(
        &self,
        buffer: &tresses::wgpu::Buffer,
        values: &[Vec<Vec3>],
        pack: impl Fn(Vec3) -> [u32; N],
    ) {
        let vertices = (0..self.vertex_count).flat_map(|i| values.iter().map(move |strand| strand[i]));
        let bytes: Vec<u8> = vertices.flat_map(pack).flat_map(u32::to_le_bytes).collect();
        self.lab.context.queue().write_buffer(buffer, 0, &bytes);
    }

    /// Returns the rest positions of the vertices by strand, meters, in groom space.
    pub fn rest_positions(&self) -> Vec<Vec<Vec3>> {
        let count = self.count();
        let position = |strand: usize, i: usize| self.rest.rest[i * count + strand].position;
        (0..count).map(|strand| (0..self.vertex_count).map(|i| position(strand, i)).collect()).collect()
    }
}

/// Returns a step in which the head moves from `begin` to `end`.
pub fn step(begin: Pose, end: Pose) -> Step {
    Step { mode: Mode::Step, begin, end, from: 0.0, to: 1.0 }
}

/// Returns the pose of a head at `translation`.
pub fn head_at(translation: Vec3) -> Pose {
    Pose { translation, ..Pose::IDENTITY }
}

/// Returns the largest relative change of an edge's length from `rest`, in either direction, or infinity if one is not
/// finite.
pub fn strain(now: &[Vec<Vec3>], rest: &[Vec<Vec3>]) -> f32 {
    let lengths = |strand: &[Vec3]| strand.windows(2).map(|w| w[0].distance(w[1])).collect::<Vec<_>>();
    let mut worst = 0f32;
    for (now, rest) in now.iter().zip(rest) {
        for (length, rest_length) in lengths(now).into_iter().zip(lengths(rest)) {
            let strain = (length / rest_length - 1.0).abs();
            worst = if strain.is_finite() { worst.max(strain) } else { f32::INFINITY };
        }
    }
    worst
}

/// Returns the length of a strand, meters.
pub fn length(strand: &[Vec3]) -> f32 {
    strand.windows(2).map(|w| w[0].distance(w[1])).sum()
}
