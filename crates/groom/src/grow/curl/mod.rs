//! Curls: offsets from a strand's path, procedural or taken from a curve that an artist drew.
//!
//! A curl is a curve around a straight axis, a function of the length along it: a helix, a flat wave or anything
//! between them ([`Curls`]), or a drawn curve ([`CurlCurve`]). It is laid along the path of a strand in a
//! parallel-transported frame and added to the result of clump or multi-strand interpolation. It therefore has no cost
//! per frame, and it rotates with the guides.
//!
//! Hair curls in locks. A *twist* holds the random parameters of one lock, which distinguish its curl from a spring:
//! radius, wavelength, handedness, phase, the point where the handedness changes, and their variation along the length.
//! The strands of a lock have slightly different phases, so they form a ribbon. [`Curls::neighbors`] is the share of
//! its phase that a lock has in common with the locks around it. A high value makes the waves of straight hair run
//! continuously, like water waves.
//!
//! Curled hair is longer than its path: by `√(1 + (2π radius / wavelength)²)` for a helix. Either the hairstyle keeps
//! its shape and the strands get longer, or the strands keep their lengths and the hairstyle gets shorter, as drying
//! hair does ([`Curls::shrink`]).
//!
//! Curls are not per guide, as they are in Tariq and Bavoil 2008. A clump-based strand follows one guide, but a
//! multi-strand is a mean of three, and the mean of three helices of different phase is meaningless. Locks are smaller
//! than the hair of one guide, and every strand belongs to one lock, whatever guides it is bound to.

mod curve;
mod twist;

pub use curve::CurlCurve;
pub(crate) use twist::{Strand, Twist};

use crate::{Error, Result, range, range::Range};

/// Curl parameters of all strands of a groom.
#[derive(Clone, Debug, PartialEq)]
pub struct Curls {
    /// Distance from the path, meters: half the diameter of a ringlet; 0 for straight hair.
    pub radius: f32,
    /// Length along the path of one turn or one wave, meters.
    pub wavelength: f32,
    /// 0 for a round helix, 1 for a wave in one plane.
    pub flatness: f32,
    /// Fraction of the length at which curls begin.
    pub start: f32,
    /// Radius at the tip relative to the radius at the root, 0 to 3.
    pub tip: f32,
    /// Variation of radius, wavelength and handedness between locks and along the length, 0 to 1.
    pub irregularity: f32,
    /// Phase coherence of the strands of a lock: 1 in phase, 0 independent.
    pub coherence: f32,
    /// Phase coherence of neighboring locks: 1 in phase, 0 independent.
    pub neighbors: f32,
    /// Share of the curls' extra length that shortens the hairstyle, 0 to 1: at 0 the outline stays and strands are
    /// longer, at 1 strands keep their length.
    pub shrink: f32,
    /// Drawn curve that replaces helix and wave.
    pub curve: Option<CurlCurve>,
}

impl Default for Curls {
    /// No curls; a radius above 0 gives ringlets.
    fn default() -> Self {
        Self { radius: 0.0, ..Self::ringlets() }
    }
}

impl Curls {
    /// Names of the presets for [`named`](Self::named), from the loosest to the tightest.
    pub const NAMES: [&'static str; 3] = ["waves", "ringlets", "coils"];

    /// Returns a preset by name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "waves" => Some(Self::waves()),
            "ringlets" => Some(Self::ringlets()),
            "coils" => Some(Self::coils()),
            _ => None,
        }
    }

    /// Loose flat waves that run continuously through the hair (type 2A on the hairdresser's scale).
    pub fn waves() -> Self {
        Self {
            radius: 0.006,
            wavelength: 0.065,
            flatness: 0.75,
            start: 0.15,
            tip: 1.2,
            irregularity: 0.5,
            coherence: 0.9,
            neighbors: 0.75,
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
            neighbors: 0.0,
            shrink: 0.0,
            curve: None,
        }
    }

    /// Tight coils as wide as a pencil (type 3C to 4A). They need short hair: 64 vertices hold ten turns.
    pub fn coils() -> Self {
        Self { radius: 0.0045, wavelength: 0.013, irregularity: 0.6, coherence: 0.8, ..Self::ringlets() }
    }

    /// Returns whether the hair has curls.
    pub fn any(&self) -> bool {
        self.radius > 0.0
    }

    /// Returns how many of `vertices` equally spaced vertices fall on each turn of a strand whose path is `length`
    /// meters long. From 8 on, curls are smooth; below [`Self::MIN_VERTICES_PER_TURN`], the vertices cannot represent
    /// them.
    pub fn vertices_per_turn(&self, length: f32, vertices: u32) -> f32 {
        // A stretched curve has the turns that it was drawn with.
        let repeats = match &self.curve {
            Some(curve) if curve.stretched => 1.0,
            _ => self.path(length) / self.wavelength.max(1e-6),
        };
        let turns = self.turns();
        vertices.saturating_sub(1) as f32 / (repeats * turns).max(1e-6)
    }

    /// Returns the turns per wavelength.
    fn turns(&self) -> f32 {
        self.curve.as_ref().map_or(1.0, CurlCurve::turns)
    }

    /// Returns the length of a path of `length` meters after shrinking, as for a helix or a wave of the same mean
    /// slope.
    fn path(&self, length: f32) -> f32 {
        let round = (0.5 * (1.0 + (1.0 - self.flatness).powi(2))).sqrt();
        let slope = std::f32::consts::TAU * self.radius * round * self.turns() / self.wavelength.max(1e-6);
        length * (1.0 + self.shrink * (1.0 / (1.0 + slope * slope).sqrt() - 1.0))
    }

    /// Minimum number of vertices per turn.
    pub const MIN_VERTICES_PER_TURN: f32 = 3.0;

    /// The range of [`radius`](Self::radius).
    pub const RADIUS: Range = range!("curl radius", 0.0 to 0.2, "m"; usually 0.0 to 0.1);
    /// The range of [`wavelength`](Self::wavelength).
    pub const WAVELENGTH: Range = range!("curl wavelength", 0.001 to 1.0, "m"; usually 0.002 to 1.0);
    /// The range of [`flatness`](Self::flatness).
    pub const FLATNESS: Range = range!("curl flatness", 0.0 to 1.0);
    /// The range of [`start`](Self::start).
    pub const START: Range = range!("curl start", 0.0 to 1.0);
    /// The range of [`tip`](Self::tip).
    pub const TIP: Range = range!("curl width at the tip", 0.0 to 3.0);
    /// The range of [`irregularity`](Self::irregularity).
    pub const IRREGULARITY: Range = range!("curl irregularity", 0.0 to 1.0);
    /// The range of [`coherence`](Self::coherence).
    pub const COHERENCE: Range = range!("curl coherence", 0.0 to 1.0);
    /// The range of [`neighbors`](Self::neighbors).
    pub const NEIGHBORS: Range = range!("similarity of neighboring curls", 0.0 to 1.0);
    /// The range of [`shrink`](Self::shrink).
    pub const SHRINK: Range = range!("curl shrinkage", 0.0 to 1.0);

    /// Checks that all values are in range.
    ///
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
        Self::NEIGHBORS.check(self.neighbors)?;
        Self::SHRINK.check(self.shrink)
    }

    /// Checks that `vertices` vertices over `length` meters of path can represent the curls.
    ///
    /// # Errors
    /// [`Error::Unusable`] if they cannot.
    pub(crate) fn fits(&self, length: f32, vertices: u32) -> Result<()> {
        if !self.any() || self.vertices_per_turn(length, vertices) >= Self::MIN_VERTICES_PER_TURN {
            return Ok(());
        }
        let (turns, path) = (self.turns(), self.path(length));
        Err(Error::Unusable(format!(
            "{vertices} vertices are too few for curls of {:.0} mm on strands of {:.0} cm; use curls of {:.0} mm or more",
            self.wavelength * 1e3,
            length * 1e2,
            (Self::MIN_VERTICES_PER_TURN * turns * path / vertices.saturating_sub(1).max(1) as f32 * 1e3)
                .ceil(),
        )))
    }
}

#[cfg(test)]
mod tests;
