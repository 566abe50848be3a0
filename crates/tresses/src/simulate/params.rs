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

/// A quantity that changes from root to tip: `root` at the root, `tip` from `falloff` metres of
/// hair on, linear between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along {
    /// Value at the root.
    pub root: f32,
    /// Value from `falloff` on.
    pub tip: f32,
    /// Arc length over which the one becomes the other, metres.
    pub falloff: f32,
}

impl Along {
    /// The range of [`falloff`](Self::falloff).
    pub const FALLOFF: Range = range!("falloff", 0.0 to 1000.0, "m"; usually 0.0 to 1.0);

    /// The value at arc length `s` (metres).
    pub fn at(&self, s: f32) -> f32 {
        self.root + (self.tip - self.root) * (s / self.falloff.max(1e-6)).clamp(0.0, 1.0)
    }
}

/// The physics of a groom. The defaults are those of real hair, except that a guide stands for a
/// lock of hairs, which is somewhat stiffer per mass than its hairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationParams {
    /// Acceleration of free fall, axes of the world, m/s².
    pub gravity: Vec3,
    /// Mass of a hair per length, kg/m.
    pub line_density: f32,
    /// Bending stiffness EI, N·m²; a hair of 80 µm has 8e-9. Multiplied by [`crate::strands::Guide::stiffness`].
    pub bending: Along,
    /// Pull towards the rest pose as the head carries it: acceleration per distance, 1/s².
    /// Multiplied by [`crate::strands::Guide::stiffness`].
    pub goal: Along,
    /// How stiff hair is against twist, as a multiple of its bending stiffness: GJ / EI, for a round fibre of keratin
    /// about 0.5: curls give way and spring back by it. 0 for hair that does not twist, which takes two thirds of the time. Hair that
    /// was made with 0 does not twist afterwards either.
    pub twist: f32,
    /// Viscosity of bending: the time in which a bend alone would relax, s. 0 for none.
    pub bending_damping: f32,
    /// Rate at which a hair takes on the velocity of the air, 1/s. A swing dies out at half this
    /// rate: of 3, a tenth is left after 1.5 s. A single hair in open air has more, a hair inside a
    /// lock less.
    pub drag: f32,
    /// Diameter of a hair, metres: what the air pushes against.
    pub diameter: f32,
    /// What the air does.
    pub wind: Wind,
    /// Coulomb's coefficient between hair and colliders.
    pub friction: f32,
    /// How much a strand that hangs by its root is stretched by gravity: the elasticity along the
    /// hair follows from it. Real hair has about 1e-6, which single precision cannot hold.
    pub stretch: f32,
    /// How much stiffer than it must be in order not to topple a guide is made that does not hang
    /// ([`rest::support`](super::rest::support)), when hair is made. Hairs that lean on each other bend as one beam: so
    /// many of them are so many times as stiff as each by itself.
    pub support: f32,
    /// What hairs do to each other.
    pub hair_hair: HairHair,
    /// Length of one fixed step, s.
    pub step: f32,
    /// Implicit solves per fixed step.
    pub substeps: u32,
}

impl Default for SimulationParams {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            line_density: 6.6e-6,
            bending: Along { root: 3.2e-8, tip: 8e-9, falloff: 0.1 },
            goal: Along { root: 120.0, tip: 0.0, falloff: 0.12 },
            twist: 0.0,
            bending_damping: 0.002,
            drag: 3.0,
            diameter: 80e-6,
            wind: Wind::default(),
            friction: 0.4,
            stretch: 5e-4,
            support: 2.0,
            hair_hair: HairHair::default(),
            step: 1.0 / 60.0,
            substeps: 4,
        }
    }
}

/// Bending is not made stiffer than this (1/s², per vertex): such hair is rigid, and single
/// precision would turn the rounding of its positions into noise.
pub const MAX_BENDING_RATE: f32 = 1e9;
/// The largest bending rate times the square of the substep and of the sine of the rest angle:
/// beyond, the twist that a bend puts on the hair above it is too stiff to be treated as a force.
pub(crate) const MAX_CURL: f32 = 20.0;
/// What a solve adds to the stiffness of an edge, per bending rate and squared sine of the angle
/// of the bend, in place of the stiffness of that twist. It is no force: it vanishes at rest.
#[cfg_attr(not(test), allow(dead_code))] // Only the twin reads it; the kernel has its own.
pub(crate) const BRAKE: f32 = 4.0;
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
    /// The range of [`support`](Self::support).
    pub const SUPPORT: Range = range!("support", 1.0 to 1000.0; usually 1.0 to 50.0);
    /// The range of [`step`](Self::step).
    pub const STEP: Range = range!("step", 0.0001 to 0.1, "s"; usually 0.001 to 0.05);

    /// Checks that every value is finite and in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is not.
    pub fn check(&self) -> Result<()> {
        let acceleration = self.gravity.abs().max_element() + self.gravity.length();
        Error::unless_within("gravity", acceleration, 0.0, 1e4, "finite and below 5,000 m/s²")?;
        self.wind.check()?;
        Self::DIAMETER.check(self.diameter)?;
        Self::LINE_DENSITY.check(self.line_density)?;
        for (along, range) in [(self.bending, Self::BENDING), (self.goal, Self::GOAL)] {
            range.check(along.root)?;
            range.check(along.tip)?;
            Along::FALLOFF.check(along.falloff)?;
        }
        Self::TWIST.check(self.twist)?;
        Self::BENDING_DAMPING.check(self.bending_damping)?;
        Self::DRAG.check(self.drag)?;
        Self::FRICTION.check(self.friction)?;
        Self::STRETCH.check(self.stretch)?;
        Self::SUPPORT.check(self.support)?;
        self.hair_hair.check()?;
        Self::STEP.check(self.step)?;
        Error::unless_within("substeps", self.substeps as f32, 1.0, MAX_SUBSTEPS as f32, "from 1 to 32")
    }

    /// Bending rate (1/s², per unit of vertex weight) at vertex `j` of a guide with stiffness factor
    /// `factor` and mean edge length `edge`, between the rest edges `before` and `next` (metres): the
    /// bend's energy per line density and edge is half of it times the square of its deviation.
    pub fn bending_rate(&self, j: usize, factor: f32, edge: f32, before: Vec3, next: Vec3) -> f32 {
        let square = edge * edge;
        let bare = factor * self.bending.at(j as f32 * edge) / (self.line_density * square * square);
        let h = if self.twist > 0.0 { 0.0 } else { self.step / self.substeps.max(1) as f32 };
        bending_rate(bare, j, before, next, h)
    }

    /// Stretching rate (1/s², per unit of vertex weight) of a guide `length` long (metres).
    pub fn stretch_rate(&self, length: f32, edge: f32) -> f32 {
        stretch_rate(self.gravity, self.stretch, length, edge)
    }
}

/// The bending rate at vertex `j` between rest edges `before` and `next`, from that of the
/// continuum: twice at the root, where half of the bend lies in the skin; limited by
/// [`MAX_BENDING_RATE`] and, where the hair curls tightly, by [`MAX_CURL`], for substeps of `h`; 0 where the solve knows
/// of twist.
pub(crate) fn bending_rate(bare: f32, j: usize, before: Vec3, next: Vec3, h: f32) -> f32 {
    let sine =
        before.cross(next).length_squared() / (before.length_squared() * next.length_squared()).max(1e-30);
    let rate = if j == 1 { 2.0 * bare } else { bare };
    rate.min(MAX_BENDING_RATE).min(MAX_CURL / (h * h * sine.max(1e-6)))
}

fn stretch_rate(gravity: Vec3, stretch: f32, length: f32, edge: f32) -> f32 {
    gravity.length().max(1.0) * length / (stretch * edge * edge)
}

/// Uniforms of one fixed step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct StepUniforms {
    /// Rotation of the head at the start of the step, quaternion.
    pub head_begin: [f32; 4],
    /// Rotation of the head at the end of the step.
    pub head_end: [f32; 4],
    /// Translation of the head at the start, metres.
    pub head_begin_at: Vec3,
    /// Length of a substep, s.
    pub h: f32,
    /// Translation of the head at the end, metres.
    pub head_end_at: Vec3,
    /// Solves per step.
    pub substeps: u32,
    /// m/s².
    pub gravity: Vec3,
    /// 1/s.
    pub drag: f32,
    /// Velocity of the air, m/s, where it is the same everywhere.
    pub wind: Vec3,
    /// Coulomb's coefficient.
    pub friction: f32,
    /// EI per line density at the root, m⁴/s².
    pub bending_root: f32,
    /// The same from the falloff on.
    pub bending_tip: f32,
    /// 1/m.
    pub bending_falloff: f32,
    /// s.
    pub bending_damping: f32,
    /// 1/s².
    pub goal_root: f32,
    /// 1/s².
    pub goal_tip: f32,
    /// 1/m.
    pub goal_falloff: f32,
    /// Square of the speed of sound along a hair of 1 m, m²/s² per m.
    pub stretch: f32,
    /// Number of guides.
    pub guide_count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// [`Mode`].
    pub mode: u32,
    /// Always one. Loops that count by it are not unrolled: unrolled, the kernel runs at less than half the
    /// speed on a CPU and takes the driver minutes to compile.
    pub one: u32,
    /// The moment of the colliders (see [`crate::collide`]) at which the step begins.
    pub moment: u32,
    /// 1 when [`crate::strands::GuideBuffers::forces`] act.
    pub forced: u32,
    /// Where in the frame's motion the step ends ([`crate::clock::Step::to`]).
    pub to: f32,
    /// How many guides are simulated, the first in the order of [`crate::lod`]; others are led.
    pub simulated: u32,
    /// How the air turns about the origin, radians per second.
    pub spin: Vec3,
    /// Slip in a substep below which friction is proportional to it, metres: 0 for friction that holds.
    pub slip: f32,
    /// Twisting stiffness as a multiple of bending stiffness; 0 for hair that does not twist.
    pub twist: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

impl StepUniforms {
    /// The uniforms of a step of `guide_count` guides with `vertex_count` vertices during which the
    /// head moves from `begin` to `end`; the frame's first.
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
            h: params.step / params.substeps.max(1) as f32,
            head_end_at: end.translation,
            substeps: params.substeps.clamp(1, MAX_SUBSTEPS),
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
