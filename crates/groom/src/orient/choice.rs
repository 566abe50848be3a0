//! The user's choice of a file's unit and axes.

use std::str::FromStr;

use glam::Vec3;

use crate::error::{Error, Result};

/// A signed coordinate axis of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub enum Axis {
    /// +X.
    X,
    /// +Y.
    Y,
    /// +Z.
    Z,
    /// −X.
    NegX,
    /// −Y.
    NegY,
    /// −Z.
    NegZ,
}

impl Axis {
    /// All six axes, the most common first.
    pub const ALL: [Self; 6] = [Self::Y, Self::Z, Self::X, Self::NegY, Self::NegZ, Self::NegX];

    /// Returns the axis as a unit vector.
    pub fn vector(self) -> Vec3 {
        match self {
            Self::X => Vec3::X,
            Self::Y => Vec3::Y,
            Self::Z => Vec3::Z,
            Self::NegX => Vec3::NEG_X,
            Self::NegY => Vec3::NEG_Y,
            Self::NegZ => Vec3::NEG_Z,
        }
    }

    /// Returns the axis closest to `v`.
    pub fn nearest(v: Vec3) -> Self {
        let mut best = Self::Y;
        for axis in Self::ALL {
            if axis.vector().dot(v) > best.vector().dot(v) {
                best = axis;
            }
        }
        best
    }

    /// Returns the opposite axis.
    pub fn opposite(self) -> Self {
        Self::nearest(-self.vector())
    }

    /// Returns the name on the command line: `y`, `-z`.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::NegX => "-x",
            Self::NegY => "-y",
            Self::NegZ => "-z",
        }
    }
}

impl FromStr for Axis {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let plain = text.trim().trim_start_matches('+').to_ascii_lowercase();
        Self::ALL.into_iter().find(|a| a.name() == plain).ok_or_else(|| Error::Parameter {
            name: "the axis",
            value: text.into(),
            range: "one of x, y, z, -x, -y, -z",
        })
    }
}

/// Meters per unit of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct LengthUnit(pub f32);

impl LengthUnit {
    /// Common units of files, with their names and meters.
    pub const KNOWN: [(&'static str, f32); 6] =
        [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("dm", 0.1), ("in", 0.0254), ("ft", 0.3048)];

    /// Returns the name of a known unit, or the number of meters.
    pub fn name(self) -> String {
        match Self::KNOWN.iter().find(|k| k.1 == self.0) {
            Some((name, _)) => (*name).into(),
            None => format!("{:.4}", self.0),
        }
    }
}

impl FromStr for LengthUnit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let plain = text.trim();
        if let Some((_, meters)) = Self::KNOWN.iter().find(|k| k.0.eq_ignore_ascii_case(plain)) {
            return Ok(Self(*meters));
        }
        match plain.parse::<f32>() {
            Ok(meters) if (1e-9..=1e9).contains(&meters) => Ok(Self(meters)),
            _ => Err(Error::Parameter {
                name: "the unit",
                value: text.into(),
                range: "m, cm, mm, dm, in, ft or a positive number of meters",
            }),
        }
    }
}

/// Known unit and axes of a file. `None` means that the importer guesses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrientationOverride {
    /// Meters per unit.
    pub unit: Option<LengthUnit>,
    /// Axis of the file that points up.
    pub up: Option<Axis>,
    /// Axis of the file along which the face looks.
    pub front: Option<Axis>,
    /// Whether the file is a mirror image, left for right.
    pub is_mirrored: Option<bool>,
}

impl OrientationOverride {
    /// A file in meters, Y up, face +Z.
    pub const METERS: Self = Self {
        unit: Some(LengthUnit(1.0)),
        up: Some(Axis::Y),
        front: Some(Axis::Z),
        is_mirrored: Some(false),
    };

    /// Returns the values on which both agree.
    pub(crate) fn shared(self, other: Self) -> Self {
        Self {
            unit: self.unit.filter(|_| self.unit == other.unit),
            up: self.up.filter(|_| self.up == other.up),
            front: self.front.filter(|_| self.front == other.front),
            is_mirrored: self.is_mirrored.filter(|_| self.is_mirrored == other.is_mirrored),
        }
    }

    /// Fills unknown values from `file`. Axes of the file that conflict with a given axis are ignored.
    pub(crate) fn or(self, file: Self) -> Self {
        let across = |axis: &Axis, given: Option<Axis>| {
            given.is_none_or(|given| given.vector().dot(axis.vector()) == 0.0)
        };
        let up = self.up.or(file.up.filter(|up| across(up, self.front)));
        Self {
            unit: self.unit.or(file.unit),
            up,
            front: self.front.or(file.front.filter(|front| across(front, up))),
            is_mirrored: self.is_mirrored.or(file.is_mirrored),
        }
    }

    /// Checks that the up and front axes are perpendicular.
    pub fn check(&self) -> Result<()> {
        match (self.up, self.front) {
            (Some(up), Some(front)) if up.vector().dot(front.vector()) != 0.0 => Err(Error::Parameter {
                name: "the front axis",
                value: front.name().into(),
                range: "at a right angle to the up axis",
            }),
            _ => Ok(()),
        }
    }
}
