//! Curls: offsets from a strand's path, procedural or taken from a curve that an artist drew.
//!
//! A curl is a curve around a straight axis, a function of the length along it: a helix, a flat wave or
//! anything between them ([`Curls`]), or a drawn curve ([`CurlCurve`]). It is laid along the path of a
//! strand in directions that are parallel transported along the path, and added to the result of clump or
//! multi-strand interpolation. It therefore costs nothing per frame, and it rotates with the guides.
//!
//! Hair curls in locks. What distinguishes a lock's curl from a spring is drawn once per lock (a *twist*):
//! radius, wavelength, handedness, phase, where the handedness changes, and how all of these vary along the
//! length. The strands of a lock follow it with slightly different phases, which lays them side by side
//! into a ribbon; a lock shares as much of its phase with the locks around it as [`Curls::neighbours`]
//! says, which makes the waves of straight hair run continuously, as water waves do.
//!
//! Curled hair is longer than its path: by `√(1 + (2π radius / wavelength)²)` for a helix. Either the
//! hairstyle keeps its shape and the strands are that much longer, or the strands keep their lengths and
//! the hairstyle gets shorter, as drying hair does ([`Curls::shrink`]).
//!
//! Why not per guide, as in the original? A clump-based strand follows one guide, but a multi-strand is a
//! mean of three, and the mean of three helices of different phase is meaningless. Locks are smaller than
//! the hair of one guide, and every strand belongs to one lock, whatever guides it is bound to.

mod curve;
mod twist;

pub use curve::CurlCurve;
pub(crate) use twist::{Strand, Twist};

use crate::{Error, Result, range, range::Range};

/// Curls in all strands of a groom.
#[derive(Clone, Debug, PartialEq)]
pub struct Curls {
    /// Distance from the path, metres: half the diameter of a ringlet; 0 for straight hair.
    pub radius: f32,
    /// Way along the path for one turn or one wave, metres.
    pub wavelength: f32,
    /// 0 for a round helix, 1 for a wave in one plane.
    pub flatness: f32,
    /// Fraction of the length at which curls begin.
    pub start: f32,
    /// Radius at the tip against that at the root, 0 to 3.
    pub tip: f32,
    /// How far radius, wavelength and hand differ from lock to lock and wander along the way, 0 to 1.
    pub irregularity: f32,
    /// How far the strands of a lock turn together: 1 in step, 0 each for itself.
    pub coherence: f32,
    /// How far a lock turns with the locks around it: 1 as one, 0 each for itself.
    pub neighbours: f32,
    /// How much of the length that curls take is taken from the hairstyle, 0 to 1: with 0 it keeps its
    /// outline and strands are longer, with 1 strands keep their length.
    pub shrink: f32,
    /// A drawn curve in place of helix and wave.
    pub curve: Option<CurlCurve>,
}

impl Default for Curls {
    /// No curls; ringlets as soon as the radius is more than 0.
    fn default() -> Self {
        Self { radius: 0.0, ..Self::ringlets() }
    }
}

impl Curls {
    /// The names that [`named`](Self::named) knows, from the loosest to the tightest.
    pub const NAMES: [&'static str; 3] = ["waves", "ringlets", "coils"];

    /// A preset by name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "waves" => Some(Self::waves()),
            "ringlets" => Some(Self::ringlets()),
            "coils" => Some(Self::coils()),
            _ => None,
        }
    }

    /// Loose flat waves that run through the hair (type 2A in the hairdresser's scale).
    pub fn waves() -> Self {
        Self {
            radius: 0.006,
            wavelength: 0.065,
            flatness: 0.75,
            start: 0.15,
            tip: 1.2,
            irregularity: 0.5,
            coherence: 0.9,
            neighbours: 0.75,
            shrink: 0.0,
            curve: None,
        }
    }

    /// Ringlets as wide as a piece of chalk (type 3A).
    pub fn ringlets() -> Self {
        Self {
            radius: 0.009,
            wavelength: 0.034,
            flatness: 0.0,
            start: 0.0,
            tip: 1.0,
            irregularity: 0.5,
            coherence: 0.92,
            neighbours: 0.0,
            shrink: 0.0,
            curve: None,
        }
    }

    /// Tight coils as wide as a pencil (type 3C to 4A). They take short hair: 64 vertices hold ten turns.
    pub fn coils() -> Self {
        Self { radius: 0.0045, wavelength: 0.013, irregularity: 0.6, coherence: 0.8, ..Self::ringlets() }
    }

    /// Whether there are any.
    pub fn any(&self) -> bool {
        self.radius > 0.0
    }

    /// How many of `vertices` equally spaced vertices fall on each turn of a strand whose path is
    /// `length` metres long. From 8 on curls are smooth; below [`Self::LEAST`] they are not curls.
    pub fn vertices_per_turn(&self, length: f32, vertices: u32) -> f32 {
        // A drawn curve that is stretched over the strand has the turns that it was drawn with.
        let repeats = match &self.curve {
            Some(curve) if curve.stretched => 1.0,
            _ => self.path(length) / self.wavelength.max(1e-6),
        };
        let turns = self.turns();
        vertices.saturating_sub(1) as f32 / (repeats * turns).max(1e-6)
    }

    /// Turns in a wavelength.
    fn turns(&self) -> f32 {
        self.curve.as_ref().map_or(1.0, CurlCurve::turns)
    }

    /// What is left of a path of `length` metres when curls shrink it: as much as for a helix, or a wave
    /// of the same mean slope.
    fn path(&self, length: f32) -> f32 {
        let round = (0.5 * (1.0 + (1.0 - self.flatness).powi(2))).sqrt();
        let slope = std::f32::consts::TAU * self.radius * round * self.turns() / self.wavelength.max(1e-6);
        length * (1.0 + self.shrink * (1.0 / (1.0 + slope * slope).sqrt() - 1.0))
    }

    /// The fewest vertices that make a turn.
    pub const LEAST: f32 = 3.0;

    /// The range of [`radius`](Self::radius).
    pub const RADIUS: Range = range!("radius of curls", 0.0 to 0.2, "metres"; usually 0.0 to 0.1);
    /// The range of [`wavelength`](Self::wavelength).
    pub const WAVELENGTH: Range = range!("wavelength of curls", 0.001 to 1.0, "metres"; usually 0.002 to 1.0);
    /// The range of [`flatness`](Self::flatness).
    pub const FLATNESS: Range = range!("flatness of curls", 0.0 to 1.0);
    /// The range of [`start`](Self::start).
    pub const START: Range = range!("start of curls", 0.0 to 1.0);
    /// The range of [`tip`](Self::tip).
    pub const TIP: Range = range!("width of curls at the tip", 0.0 to 3.0);
    /// The range of [`irregularity`](Self::irregularity).
    pub const IRREGULARITY: Range = range!("irregularity of curls", 0.0 to 1.0);
    /// The range of [`coherence`](Self::coherence).
    pub const COHERENCE: Range = range!("coherence of curls", 0.0 to 1.0);
    /// The range of [`neighbours`](Self::neighbours).
    pub const NEIGHBOURS: Range = range!("likeness of neighbouring curls", 0.0 to 1.0);
    /// The range of [`shrink`](Self::shrink).
    pub const SHRINK: Range = range!("shrinking by curls", 0.0 to 1.0);

    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a value out of range.
    pub fn check(&self) -> Result<()> {
        Self::RADIUS.check(self.radius)?;
        Self::WAVELENGTH.check(self.wavelength)?;
        Self::FLATNESS.check(self.flatness)?;
        Self::START.check(self.start)?;
        Self::TIP.check(self.tip)?;
        Self::IRREGULARITY.check(self.irregularity)?;
        Self::COHERENCE.check(self.coherence)?;
        Self::NEIGHBOURS.check(self.neighbours)?;
        Self::SHRINK.check(self.shrink)
    }

    /// # Errors
    /// [`Error::Unusable`] where `vertices` vertices over `length` metres of path hold no such curl.
    pub(crate) fn fits(&self, length: f32, vertices: u32) -> Result<()> {
        if !self.any() || self.vertices_per_turn(length, vertices) >= Self::LEAST {
            return Ok(());
        }
        let (turns, path) = (self.turns(), self.path(length));
        Err(Error::Unusable(format!(
            "{vertices} vertices are too few for curls of {:.0} mm on strands of {:.0} cm: from {:.0} mm on they hold",
            self.wavelength * 1e3,
            length * 1e2,
            (Self::LEAST * turns * path / vertices.saturating_sub(1).max(1) as f32 * 1e3).ceil(),
        )))
    }
}

#[cfg(test)]
mod tests;
