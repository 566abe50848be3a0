//! Curls drawn by an artist.

use crate::error::{At, Error, Result};
use crate::{
    curve,
    formats::{parse::parse, source::Files},
};
use glam::Vec3;
use std::path::Path;

/// Points of a drawn curve at equal steps of its arc length.
const POINTS: usize = 256;

/// One or more turns of a curl drawn by an artist, without a size: offsets from its axis at equal steps of arc length,
/// the largest of length 1.
///
/// The axis is parallel to the line from the first vertex to the last and passes through the mean of the curve. The
/// offsets at both ends are therefore equal, and repeated curls join without a break.
#[derive(Clone, Debug, PartialEq)]
pub struct CurlCurve {
    /// x and y: across the axis. z: advance along the axis relative to a uniform advance.
    offsets: Vec<Vec3>,
    /// Length along the axis divided by the largest distance from it.
    proportion: f32,
    turns: f32,
    /// Whether the curve spans the whole strand once instead of repeating every wavelength.
    pub stretched: bool,
}

impl CurlCurve {
    /// Creates a curl from the polyline `points`, in any unit, from root to tip.
    ///
    /// # Errors
    /// [`Error::Unusable`] for fewer than three points, a closed curve, a straight curve, or coordinates that are not
    /// finite.
    pub fn new(points: &[Vec3]) -> Result<Self> {
        let refuse = |what: &str| Err(Error::Unusable(format!("the curl curve {what}")));
        if points.len() < 3 {
            return refuse("has fewer than three points");
        }
        if points.iter().any(|p| !p.is_finite()) {
            return refuse("has coordinates that are not finite");
        }
        let even = curve::resample_chords(points, POINTS);
        let chord = even[POINTS - 1] - even[0];
        let axis = chord.normalize_or_zero();
        if chord.length() <= 1e-3 * curve::length(points) {
            return refuse("is closed, so it has no axis");
        }
        let across = |p: Vec3| p - axis * p.dot(axis);
        // The end repeats the beginning and must not count twice.
        let center =
            even[..POINTS - 1].iter().map(|p| across(*p - even[0])).sum::<Vec3>() / (POINTS - 1) as f32;
        let out: Vec<Vec3> = even.iter().map(|p| across(*p - even[0]) - center).collect();
        let largest = out.iter().map(|o| o.length()).fold(0.0, f32::max);
        if largest < 1e-4 * chord.length() {
            return refuse("is straight");
        }
        let u = out[0].normalize_or(axis.any_orthonormal_vector());
        let v = axis.cross(u);
        let offsets: Vec<Vec3> = (0..POINTS)
            .map(|i| {
                let even_advance = chord.length() * i as f32 / (POINTS - 1) as f32;
                let axial_offset = (even[i] - even[0]).dot(axis) - even_advance;
                Vec3::new(out[i].dot(u), out[i].dot(v), axial_offset) / largest
            })
            .collect();
        let turns = turns(&offsets);
        Ok(Self { offsets, proportion: chord.length() / largest, turns, stretched: false })
    }

    /// Reads the groom file at `path`, which must contain exactly one strand (OBJ lines, or any other format for
    /// strands).
    ///
    /// # Errors
    /// Errors of the reader; [`Error::File`] for a file with several curves or a curve that [`new`](Self::new) rejects.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path, &Files::Disk.load(path)?)
    }

    /// [`read`](Self::read) from bytes. `path` selects the format and appears in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self> {
        let raw = parse(path, bytes, false)?;
        let wrong = |problem| Error::File { path: path.to_path_buf(), at: At::File, problem };
        if raw.strands.len() != 1 {
            return Err(wrong(format!("the file has {} curves, but a curl is one curve", raw.strands.len())));
        }
        Self::new(raw.strands.strand(0)).map_err(|error| wrong(error.to_string()))
    }

    /// Returns the length along the axis of the whole curve, as drawn, with a radius of `radius` meters.
    pub fn length_for(&self, radius: f32) -> f32 {
        self.proportion * radius
    }

    /// Returns the approximate number of turns or waves.
    pub fn turns(&self) -> f32 {
        self.turns
    }

    /// Returns the offset at the fraction `s` of the curve, which repeats outside of 0 to 1: x and y across the axis, z
    /// along it. The largest offset across has length 1.
    pub fn at(&self, s: f32) -> Vec3 {
        let x = (s - s.floor()) * (POINTS - 1) as f32;
        let i = (x as usize).min(POINTS - 2);
        self.offsets[i].lerp(self.offsets[i + 1], x - i as f32)
    }
}

/// Counts the turns or waves of the offsets: half the number of crossings of the plane through the axis that is
/// perpendicular to the largest offset, at least 1.
fn turns(offsets: &[Vec3]) -> f32 {
    let far = offsets.iter().copied().max_by(|a, b| a.x.hypot(a.y).total_cmp(&b.x.hypot(b.y)));
    let direction = far.unwrap_or(Vec3::X).truncate().normalize_or_zero();
    let side = |o: &Vec3| o.truncate().dot(direction) >= 0.0;
    let crossings = offsets.windows(2).filter(|w| side(&w[0]) != side(&w[1])).count();
    (crossings as f32 / 2.0).max(1.0)
}
