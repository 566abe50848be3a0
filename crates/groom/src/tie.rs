//! Ties: bands, braids and pins.

use crate::{Error, Result, range, range::Range};
use glam::Vec3;

/// Whether a [`Tie`] holds hair together or to the head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum TieTarget {
    /// The held vertices form one rigid piece that moves with the hair: a band, a braid.
    #[default]
    Together,
    /// The held vertices stay at their rest positions on the head: a pin, a clip.
    ToHead,
}

/// Holds all guides that pass within `radius` of the line between two points, in groom space at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tie {
    /// Start of the line, meters.
    pub from: Vec3,
    /// End of the line, meters; equal to `from` for a ball.
    pub to: Vec3,
    /// Radius around the line, meters.
    pub radius: f32,
    /// Whether the hair is held together or to the head.
    pub held: TieTarget,
    /// Factor of the held vertices' distance from their center at rest: 1 keeps it, smaller values draw hair together.
    pub gather: f32,
    /// Group whose guides are held ([`Guides::groups`](crate::Guides::groups)); `None` for all guides.
    pub group: Option<i32>,
}

impl Tie {
    /// The range of [`gather`](Self::gather).
    pub const GATHER: Range = range!("tie gather", 0.02 to 1.0);
    /// The range of [`radius`](Self::radius).
    pub const RADIUS: Range = range!("tie radius", 0.0005 to 1.0, "m"; usually 0.002 to 0.05);

    /// Checks that all values are finite and in range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first invalid value.
    pub fn check(&self) -> Result<()> {
        let far = self.from.abs().max(self.to.abs()).max_element() + (self.from + self.to).length();
        Error::unless_within("tie position", far, 0.0, 1e3, "finite and within 1 km")?;
        Self::RADIUS.check(self.radius)?;
        Self::GATHER.check(self.gather)
    }

    /// Returns the parameter, from 0 to 1, of the point of the line nearest to `x`, and the distance to it.
    fn nearest(&self, x: Vec3) -> (f32, f32) {
        let line = self.to - self.from;
        let along = ((x - self.from).dot(line) / line.length_squared().max(1e-12)).clamp(0.0, 1.0);
        (along, x.distance(self.from + line * along))
    }

    /// Returns the vertices of a strand at rest that the tie holds, with their parameters along the line. The two root
    /// vertices are never held, because they follow the head. If the strand passes through between two vertices, the
    /// nearer one is held.
    pub fn holds(&self, strand: &[Vec3]) -> Vec<(usize, f32)> {
        let at = |i: usize| self.nearest(strand[i]);
        let inside = (2..strand.len()).filter(|&i| at(i).1 <= self.radius);
        let found: Vec<_> = inside.map(|i| (i, at(i).0)).collect();
        if !found.is_empty() {
            return found;
        }
        let passes = |i: usize| {
            let point = |k: i32| strand[i - 1].lerp(strand[i], k as f32 / 8.0);
            (1..8).any(|k| self.nearest(point(k)).1 <= self.radius)
        };
        let Some(i) = (2..strand.len()).find(|&i| passes(i)) else { return Vec::new() };
        let nearer = if i > 2 && at(i - 1).1 < at(i).1 { i - 1 } else { i };
        vec![(nearer, at(nearer).0)]
    }

    /// Returns the number of rings: rigid pieces no longer than they are wide; 1 to the head.
    pub fn rings(&self) -> usize {
        match self.held {
            TieTarget::Together => {
                ((self.from.distance(self.to) / (2.0 * self.radius)).round() as usize).max(1)
            }
            TieTarget::ToHead => 1,
        }
    }
}
