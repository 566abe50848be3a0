//! User parameters, in SI units, and the uniforms of one fixed step.

use crate::{
    Error, Pose, Result,
    clock::{MAX_SUBSTEPS, Mode},
    groom::range,
    range::Range,
    volume::HairHair,
    wind::Wind,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A quantity that varies linearly along the hair: `root` at the root, `tip` beyond `falloff` meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootToTip {
    /// Value at the root.
    pub root: f32,
    /// Value at arc length `falloff` and beyond.
    pub tip: f32,
    /// Arc length over which the value changes, meters.
    pub falloff: f32,
}

impl RootToTip {
    /// The range of [`falloff`](Self::falloff).
    pub const FALLOFF: Range = range!("falloff", 0.0 to 1000.0, "m"; usually 0.0 to 1.0);

    /// Returns the value at arc length `s` (meters).
    pub fn at(&self, s: f32) -> f32 {
        self.root + (self.tip - self.root) * (s / self.falloff.max(1e-6)).clamp(0.0, 1.0)
    }
}

/// Physical parameters of a groom. The defaults describe real hair, but somewhat stiffer per mass, because a guide
/// represents a lock of hairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationParams {
    /// Gravitational acceleration in world axes, m/s².
    pub gravity: Vec3,
    /// Mass of a hair per length, kg/m.
    pub line_density: f32,
    /// Bending stiffness EI, N·m²; 8e-9 for a hair of 80 µm. Multiplied by the guide's own stiffness.
    pub bending: RootToTip,
    /// Shape stiffness: pull towards the rest pose that moves with the head, as acceleration per distance, 1/s².
    /// Multiplied by the guide's own stiffness.
    pub goal: RootToTip,
    /// Torsional stiffness as a multiple of bending stiffness, GJ / EI: about 0.5 for a round keratin fiber. Curls
    /// yield and spring back by it. 0 disables twist; a step then takes two thirds of the time.
    pub twist: f32,
    /// Bending viscosity: relaxation time of a bend on its own, s. 0 for none.
    pub bending_damping: f32,
    /// Rate at which hair approaches the velocity of the air, 1/s. A swing decays at half this rate: with 3, a tenth
    /// remains after 1.5 s. A single hair in open air has more, a hair inside a lock less.
    pub drag: f32,
    /// Hair diameter that the air acts on, meters.
    pub diameter: f32,
    /// Wind and air.
    pub wind: Wind,
    /// Coulomb friction coefficient between hair and colliders.
    pub friction: f32,
    /// Strain under gravity of a strand that hangs from its root; it determines the stiffness along the hair. Real hair
    /// has about 1e-6, which single precision cannot represent.
    pub stretch: f32,
    /// Hair–hair interaction.
    pub hair_hair: HairHair,
    /// Length of one fixed step, s.
    pub step: f32,
    /// Implicit solves per fixed step.
    pub substep_count: u32,
}

impl Default for SimulationParams {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            line_density: 6.6e-6,
            bending: RootToTip { root: 3.2e-8, tip: 8e-9, falloff: 0.1 },
            goal: RootToTip { root: 120.0, tip: 0.0, falloff: 0.12 },
            twist: 0.0,
            bending_damping: 0.002,
            drag: 3.0,
            diameter: 80e-6,
            wind: Wind::default(),
            friction: 0.4,
            stretch: 5e-4,
            hair_hair: HairHair::default(),
            step: 1.0 / 60.0,
            substep_count: 4,
        }
    }
}

/// Largest bending rate, 1/s² per vertex. Stiffer hair is rigid, and in single precision the rounding of its positions
/// would become noise.
pub const MAX_BENDING_RATE: f32 = 1e9;
/// Largest product of bending rate, squared substep and squared sine of the rest angle. Beyond it, the twist that a
/// bend exerts on the hair above is too stiff for an explicit force.
pub(crate) const MAX_CURL: f32 = 20.0;
impl SimulationParams {
    /// The range of [`line_density`](Self::line_density).
    pub const LINE_DENSITY: Range = range!("line density", 1e-9 to 1.0, "kg/m"; usually 5e-7 to 1e-4);
    /// The range of both ends of [`bending`](Self::bending).
    pub const BENDING: Range = range!("bending stiffness", 0.0 to 1.0, "N·m²"; usually 0.0 to 1e-6);
    /// The range of both ends of [`goal`](Self::goal).
    pub const GOAL: Range = range!("goal stiffness", 0.0 to 1e7, "1/s²"; usually 0.0 to 1e4);
    /// The range of [`twist`](Self::twist).
    pub const TWIST: Range = range!("twist stiffness", 0.0 to 100.0; usually 0.0 to 10.0);
    /// The range of [`bending_damping`](Self::bending_damping).
    pub const BENDING_DAMPING: Range = range!("bending damping", 0.0 to 10.0, "s"; usually 0.0 to 0.1);
    /// The range of [`drag`](Self::drag).
    pub const DRAG: Range = range!("drag", 0.0 to 1e4, "1/s"; usually 0.0 to 100.0);
    /// The range of [`diameter`](Self::diameter).
    pub const DIAMETER: Range = range!("hair diameter", 1e-6 to 0.01, "m"; usually 1e-5 to 1e-3);
    /// The range of [`friction`](Self::friction).
    pub const FRICTION: Range = range!("friction", 0.0 to 100.0; usually 0.0 to 10.0);
    /// The range of [`stretch`](Self::stretch).
    pub const STRETCH: Range = range!("stretch", 1e-5 to 0.1);
    /// The range of [`step`](Self::step).
    pub const STEP: Range = range!("step", 0.0001 to 0.1, "s"; usually 0.001 to 0.05);

    /// Checks that every value is finite and in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first invalid value.
    pub fn check(&self) -> Result<()> {
        let acceleration = self.gravity.abs().max_element() + self.gravity.length();
        Error::unless_within("gravity", acceleration, 0.0, 1e4, "finite and below 5,000 m/s²")?;
        self.wind.check()?;
        Self::DIAMETER.check(self.diameter)?;
        Self::LINE_DENSITY.check(self.line_density)?;
        for (along, range) in [(self.bending, Self::BENDING), (self.goal, Self::GOAL)] {
            range.check(along.root)?;
            range.check(along.tip)?;
            RootToTip::FALLOFF.check(along.falloff)?;
        }
        Self::TWIST.check(self.twist)?;
        Self::BENDING_DAMPING.check(self.bending_damping)?;
        Self::DRAG.check(self.drag)?;
        Self::FRICTION.check(self.friction)?;
        Self::STRETCH.check(self.stretch)?;
        self.hair_hair.check()?;
        Self::STEP.check(self.step)?;
        Error::unless_within("substeps", self.substep_count as f32, 1.0, MAX_SUBSTEPS as f32, "from 1 to 32")
    }

    /// Returns the bending rate (1/s², per unit of vertex weight) at vertex `j` of a guide with stiffness factor
    /// `factor` and mean edge length `edge`, between the rest edges `before` and `next` (meters). The bend's energy per
    /// line density and edge is half the rate times the square of its deviation.
    pub fn bending_rate(&self, j: usize, factor: f32, edge: f32, before: Vec3, next: Vec3) -> f32 {
        let square = edge * edge;
        let continuum_rate =
            factor * self.bending.at(j as f32 * edge) / (self.line_density * square * square);
        let h = if self.twist > 0.0 { 0.0 } else { self.step / self.substep_count.max(1) as f32 };
        bending_rate(continuum_rate, j, before, next, h)
    }

    /// Returns the stretching rate (1/s², per unit of vertex weight) of a guide of `length` meters.
    pub fn stretch_rate(&self, length: f32, edge: f32) -> f32 {
        stretch_rate(self.gravity, self.stretch, length, edge)
    }
}

/// Returns the bending rate at vertex `j` between rest edges `before` and `next`, from the continuum's rate
/// `continuum_rate`. It is doubled at the root, where half of the bend lies in the skin, and limited by
/// [`MAX_BENDING_RATE`]. Tight curls are limited by [`MAX_CURL`] for substeps of `h`; `h` is 0 where the solve includes
/// twist.
pub(crate) fn bending_rate(continuum_rate: f32, j: usize, before: Vec3, next: Vec3, h: f32) -> f32 {
    let sine =
        before.cross(next).length_squared() / (before.length_squared() * next.length_squared()).max(1e-30);
    let rate = if j == 1 { 2.0 * continuum_rate } else { continuum_rate };
    rate.min(MAX_BENDING_RATE).min(MAX_CURL / (h * h * sine.max(1e-6)))
}

fn stretch_rate(gravity: Vec3, stretch: f32, length: f32, edge: f32) -> f32 {
    gravity.length().max(1.0) * length / (stretch * edge * edge)
}

/// Uniforms of one fixed step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct StepUniforms {
    /// Rotation of the head at the start of the step, quaternion.
    pub head_begin: [f32; 4],
    /// Rotation of the head at the end of the step.
    pub head_end: [f32; 4],
    /// Translation of the head at the start, meters.
    pub head_begin_at: Vec3,
    /// Length of a substep, s.
    pub h: f32,
    /// Translation of the head at the end, meters.
    pub head_end_at: Vec3,
    /// Solves per step.
    pub substeps: u32,
    /// Gravitational acceleration, m/s².
    pub gravity: Vec3,
    /// Drag rate, 1/s.
    pub drag: f32,
    /// Velocity of uniform air, m/s.
    pub wind: Vec3,
    /// Coulomb friction coefficient.
    pub friction: f32,
    /// EI per line density at the root, m⁴/s².
    pub bending_root: f32,
    /// EI per line density from the falloff on, m⁴/s².
    pub bending_tip: f32,
    /// Reciprocal of the bending falloff, 1/m.
    pub bending_falloff: f32,
    /// Bending viscosity, s.
    pub bending_damping: f32,
    /// Shape stiffness at the root, 1/s².
    pub goal_root: f32,
    /// Shape stiffness from the falloff on, 1/s².
    pub goal_tip: f32,
    /// Reciprocal of the shape stiffness falloff, 1/m.
    pub goal_falloff: f32,
    /// Square of the speed of sound along a hair of 1 m, m²/s² per m.
    pub stretch: f32,
    /// Number of guides.
    pub guide_count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// [`Mode`] of the step.
    pub mode: u32,
    /// Always 1. Loops that increment by it are not unrolled; unrolled, the kernel runs at less than half the speed on
    /// a CPU and takes the driver minutes to compile.
    pub one: u32,
    /// Collider moment (see [`crate::collide`]) at the start of the step.
    pub moment: u32,
    /// 1 if [`crate::strands::GuideBuffers::forces`] act.
    pub forced: u32,
    /// End of the step as a fraction of the frame's motion ([`crate::clock::Step::to`]).
    pub to: f32,
    /// Number of simulated guides, the first in the order of [`crate::lod`]; the others follow them.
    pub simulated: u32,
    /// Angular velocity of the air about the origin, rad/s.
    pub spin: Vec3,
    /// Slip per substep below which friction is proportional to it, meters; 0 for static friction.
    pub slip: f32,
    /// Torsional stiffness as a multiple of bending stiffness; 0 without twist.
    pub twist: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

impl StepUniforms {
    /// Returns the uniforms of the frame's first step, for `guide_count` guides of `vertex_count` vertices. The head
    /// moves from `begin` to `end` during the step.
    pub fn new(
        params: &SimulationParams,
        guide_count: u32,
        vertex_count: u32,
        mode: Mode,
        begin: &Pose,
        end: &Pose,
    ) -> Self {
        Self {
            head_begin: begin.rotation.into(),
            head_end: end.rotation.into(),
            head_begin_at: begin.translation,
            h: params.step / params.substep_count.max(1) as f32,
            head_end_at: end.translation,
            substeps: params.substep_count.clamp(1, MAX_SUBSTEPS),
            gravity: params.gravity,
            drag: params.drag,
            wind: if params.wind.blows() { Vec3::ZERO } else { params.wind.velocity },
            friction: params.friction,
            bending_root: params.bending.root / params.line_density,
            bending_tip: params.bending.tip / params.line_density,
            bending_falloff: 1.0 / params.bending.falloff.max(1e-6),
            bending_damping: params.bending_damping,
            twist: params.twist,
            goal_root: params.goal.root,
            goal_tip: params.goal.tip,
            goal_falloff: 1.0 / params.goal.falloff.max(1e-6),
            stretch: params.gravity.length().max(1.0) / params.stretch,
            guide_count,
            vertex_count,
            simulated: guide_count,
            mode: mode as u32,
            one: 1,
            ..Self::zeroed()
        }
    }
}
