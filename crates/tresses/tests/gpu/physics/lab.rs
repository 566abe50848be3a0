//! Strands on the GPU, a head that moves them, and what they do.

use crate::common;
use std::sync::OnceLock;
use tresses::{
    Context, Pose,
    clock::{Clock, MAX_STEPS, Mode, Step},
    collide::{ColliderDescriptor, ColliderPoses, ColliderSet, Moments},
    glam::Vec3,
    gpu::readback::blocking as readback,
    groom::SdfGrid,
    simulate::{Along, GuideTraits, RestOptions, RestShape, Simulation, SimulationParams, rest},
    strands::{
        GuideBuffers, RestGuides,
        guide::{pack_velocity, unpack_velocity},
    },
};

/// An adapter and the pipelines, which all cases share.
pub struct Lab {
    pub context: &'static Context,
}

/// The laboratory, or `None` where the machine has no adapter and need not have one.
pub fn lab() -> Option<&'static Lab> {
    static LAB: OnceLock<Option<Lab>> = OnceLock::new();
    LAB.get_or_init(|| Some(Lab { context: common::context()? })).as_ref()
}

/// Hair of one bending stiffness (N·m²) and nothing else: no goal, no drag, no damping.
pub fn bare(bending: f32) -> SimulationParams {
    let along = |v| Along { root: v, tip: v, falloff: 1.0 };
    SimulationParams {
        bending: along(bending),
        goal: along(0.0),
        bending_damping: 0.0,
        drag: 0.0,
        friction: 0.0,
        ..Default::default()
    }
}

/// A straight strand of `n` vertices whose free part, from vertex 1 on, starts at the origin and is
/// `length` long.
pub fn straight(n: usize, length: f32, dir: Vec3) -> Vec<Vec3> {
    let edge = length / (n - 2) as f32;
    (0..n).map(|i| dir * edge * (i as f32 - 1.0)).collect()
}

/// Strands of one number of vertices.
pub struct Experiment {
    lab: &'static Lab,
    pub params: SimulationParams,
    pub rest: RestGuides,
    pub n: usize,
    /// Where the colliders are that it is [among](Self::among).
    pub obstacles: ColliderPoses,
    guides: GuideBuffers,
    colliders: ColliderSet,
    simulation: Simulation,
    clock: Clock,
}

impl Experiment {
    /// `strands` at rest, which is also where they start.
    pub fn new(
        lab: &'static Lab,
        strands: &[Vec<Vec3>],
        traits: &[GuideTraits],
        params: SimulationParams,
        shape: RestShape,
        field: Option<&SdfGrid>,
    ) -> Self {
        let n = strands[0].len();
        let options = RestOptions { shape, clearance: 1.5e-3 };
        let rest = rest::guides(&strands.concat(), n as u32, traits, &params, &options, field).unwrap();
        let context = lab.context;
        let guides = GuideBuffers::new(context, strands.len() as u32, n as u32, 2).unwrap();
        let guides = if params.twist > 0.0 { guides.with_twist(context).unwrap() } else { guides };
        rest.upload(context, &guides).unwrap();
        let obstacles = ColliderDescriptor { head: field, ..Default::default() };
        let colliders = ColliderSet::new(context, &obstacles).unwrap();
        let simulation = Simulation::new(context, &guides);
        let (obstacles, clock) = (ColliderPoses::default(), Clock::default());
        Self { colliders, lab, params, rest, n, obstacles, guides, simulation, clock }
    }

    /// Among `what`, which is at `obstacles`, instead of the head's field.
    pub fn among(mut self, what: &ColliderDescriptor<'_>, at: Vec<Pose>) -> Self {
        let context = self.lab.context;
        self.colliders = ColliderSet::new(context, what).unwrap();
        self.obstacles.colliders = at;
        self
    }

    pub fn count(&self) -> usize {
        self.rest.info.len()
    }

    /// Any number of fixed steps.
    pub fn steps(&mut self, steps: &[Step]) {
        let context = self.lab.context;
        for steps in steps.chunks(MAX_STEPS as usize) {
            let (substeps, head) = (self.params.substeps, steps[steps.len() - 1].end);
            let moments = Moments { steps, substeps, step: self.params.step, head, alpha: 1.0 };
            self.colliders.advance(&self.obstacles, &moments).unwrap();
            common::compute(context, |pass| {
                self.simulation.run(context, pass, &self.params, steps, &self.colliders).unwrap();
            });
        }
    }

    /// `count` steps during which the head keeps still.
    pub fn still(&mut self, count: usize) {
        self.steps(&vec![step(Pose::IDENTITY, Pose::IDENTITY); count]);
    }

    /// `seconds` of a moving head in fixed steps; `motion` gives its pose at every time.
    pub fn moved(&mut self, seconds: f32, motion: impl Fn(f32) -> Pose) {
        let count = (seconds / self.params.step).round() as usize;
        let at = |i: usize| motion(i as f32 * self.params.step);
        let steps: Vec<_> = (0..count).map(|i| step(at(i), at(i + 1))).collect();
        self.steps(&steps);
    }

    /// A frame: as many steps as are due `dt` after the last, the head now at `head`.
    pub fn frame(&mut self, dt: f32, head: Pose) {
        let ticks = self.clock.tick(dt, self.params.step, &head);
        self.steps(&ticks.steps);
    }

    /// Positions, guide by guide, metres.
    pub fn positions(&self) -> Vec<Vec<Vec3>> {
        self.read(&self.guides.current, |v: &[f32; 4]| Vec3::from_slice(v))
    }

    /// Velocities, guide by guide, m/s.
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
        (0..count).map(|g| (0..self.n).map(|i| unpack(&all[i * count + g])).collect()).collect()
    }

    /// Puts the strands somewhere else.
    pub fn place(&self, positions: &[Vec<Vec3>]) {
        self.write(&self.guides.current, positions, |p| p.extend(0.0).to_array().map(f32::to_bits));
    }

    /// Gives the strands velocities.
    pub fn throw(&self, velocities: &[Vec<Vec3>]) {
        self.write(&self.guides.velocity, velocities, pack_velocity);
    }

    fn write<const N: usize>(
        &self,
        buffer: &tresses::wgpu::Buffer,
        values: &[Vec<Vec3>],
        pack: impl Fn(Vec3) -> [u32; N],
    ) {
        let vertices = (0..self.n).flat_map(|i| values.iter().map(move |strand| strand[i]));
        let bytes: Vec<u8> = vertices.flat_map(pack).flat_map(u32::to_le_bytes).collect();
        self.lab.context.queue().write_buffer(buffer, 0, &bytes);
    }

    /// Each strand's vertices at rest, groom space.
    pub fn at_rest(&self) -> Vec<Vec<Vec3>> {
        let count = self.count();
        let at = |g: usize, i: usize| self.rest.rest[i * count + g].position;
        (0..count).map(|g| (0..self.n).map(|i| at(g, i)).collect()).collect()
    }
}

/// A step of a moving head.
pub fn step(begin: Pose, end: Pose) -> Step {
    Step { mode: Mode::Step, begin, end, from: 0.0, to: 1.0 }
}

/// A head at `translation`.
pub fn head_at(translation: Vec3) -> Pose {
    Pose { translation, ..Pose::IDENTITY }
}

/// The largest change of an edge's length against `rest`, either way.
pub fn strain(now: &[Vec<Vec3>], rest: &[Vec<Vec3>]) -> f32 {
    let lengths = |strand: &[Vec3]| strand.windows(2).map(|w| w[0].distance(w[1])).collect::<Vec<_>>();
    let mut worst = 0f32;
    for (now, rest) in now.iter().zip(rest) {
        for (l, l0) in lengths(now).into_iter().zip(lengths(rest)) {
            let strain = (l / l0 - 1.0).abs();
            worst = if strain.is_finite() { worst.max(strain) } else { f32::INFINITY };
        }
    }
    worst
}

/// The length of a strand, metres.
pub fn length(strand: &[Vec3]) -> f32 {
    strand.windows(2).map(|w| w[0].distance(w[1])).sum()
}
