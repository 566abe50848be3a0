//! Parameters of the built-in styles.

use crate::{Error, Result};
use std::str::FromStr;

/// A pair of values: for hair rooted low on the head (nape, sides) and for hair rooted on top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowTop {
    /// Value at the lowest roots.
    pub low: f32,
    /// Value at the highest roots.
    pub top: f32,
}

impl LowTop {
    const fn new(low: f32, top: f32) -> Self {
        Self { low, top }
    }

    /// Returns the value at the layer `t`, 0 for the lowest roots and 1 for the highest.
    pub fn at(self, t: f32) -> f32 {
        self.low + (self.top - self.low) * t
    }
}

/// Hold of a style while it is draped, like a hairdresser's spray. Without it, every style would hang from the head
/// like wet hair. Bending and pull are multiplied by the guide's stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// Multiplier of the bending stiffness.
    pub bending: f32,
    /// Pull toward the combed shape at the roots, acceleration per distance, 1/s².
    pub root: f32,
    /// Pull toward the combed shape from 20 cm of hair on, 1/s².
    pub tip: f32,
}

/// All parameters of a hairstyle. [`Long`], [`Bob`], [`Curly`] and [`Short`] are short forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Exact number of guides.
    pub guides: u32,
    /// Seed of every random choice.
    pub seed: u32,
    /// Height of the hairline above its usual place, meters.
    pub hairline_raise: f32,
    /// Irregularity of the hairline, meters.
    pub hairline_irregularity: f32,
    /// Distance of the parting from the middle, meters, positive to the head's left; `None` for
    /// hair that grows from a whorl at the crown.
    pub parting: Option<f32>,
    /// Half the width of the bare strip at the parting, meters.
    pub parting_half_width: f32,
    /// Irregularity of the parting, meters.
    pub parting_wander: f32,
    /// Maximum length along the guide, meters.
    pub length: LowTop,
    /// Minimum length, meters.
    pub shortest: f32,
    /// Height of the ends below the chin, meters (negative: above), where strands that are long
    /// enough are cut; `None` for no common hem.
    pub hem: Option<f32>,
    /// Unevenness of the hem, meters.
    pub hem_softness: f32,
    /// Angle between the scalp and the hair at the root, radians.
    pub lift: LowTop,
    /// Distance of the hair from the skin over the head, meters.
    pub volume: LowTop,
    /// Pull of the comb toward the back of the head, relative to its pull away from the parting.
    pub back: f32,
    /// Pull of the comb toward the face on top of the head.
    pub forward: f32,
    /// Weight of gravity relative to the comb on the head.
    pub gravity: f32,
    /// Length over which hair turns to a new direction, meters.
    pub bend: f32,
    /// Amplitude of the wave, meters.
    pub wave: f32,
    /// Length of the wave, meters.
    pub wavelength: f32,
    /// Strength with which the ends turn in toward the neck, 0 to 1.
    pub tip_in: f32,
    /// Difference in direction between neighboring guides, radians.
    pub tousle: f32,
    /// Whether hair rooted above the forehead falls over it as a fringe.
    pub fringe: bool,
    /// Stiffness of the guides relative to the simulation's parameter.
    pub stiffness: LowTop,
    /// Hold of the style while it is draped.
    pub hold: Hold,
}

/// Long hair with a soft wave, parted at the side; the default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Long {
    /// Number of guides.
    pub guides: u32,
    /// Seed of every random choice.
    pub seed: u32,
    /// Maximum length, meters.
    pub length: f32,
    /// Distance of the parting from the middle, meters, positive to the head's left.
    pub parting: f32,
    /// Amplitude of the wave, meters.
    pub wave: f32,
}

impl Default for Long {
    fn default() -> Self {
        Self { guides: 166, seed: 1, length: 0.32, parting: 0.022, wave: 0.0125 }
    }
}

/// Jaw-length hair with a soft edge that turns in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bob {
    /// Number of guides.
    pub guides: u32,
    /// Seed of every random choice.
    pub seed: u32,
    /// Height of the edge above the chin, meters.
    pub edge: f32,
    /// Distance of the parting from the middle, meters, positive to the head's left.
    pub parting: f32,
    /// Whether hair falls over the forehead.
    pub fringe: bool,
}

impl Default for Bob {
    fn default() -> Self {
        Self { guides: 200, seed: 1, edge: 0.02, parting: 0.0, fringe: false }
    }
}

/// Spirals all around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curly {
    /// Number of guides.
    pub guides: u32,
    /// Seed of every random choice.
    pub seed: u32,
    /// Length along the axis of the spirals, meters.
    pub length: f32,
    /// Diameter of the spirals, meters.
    pub diameter: f32,
}

impl Default for Curly {
    fn default() -> Self {
        Self { guides: 240, seed: 1, length: 0.2, diameter: 0.018 }
    }
}

/// A textured crop, shorter at the sides and the nape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Short {
    /// Number of guides.
    pub guides: u32,
    /// Seed of every random choice.
    pub seed: u32,
    /// Length on top, meters.
    pub top: f32,
    /// Length at the sides and the nape, meters.
    pub sides: f32,
}

impl Default for Short {
    fn default() -> Self {
        Self { guides: 400, seed: 1, top: 0.058, sides: 0.03 }
    }
}

/// A hairstyle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Style {
    /// See [`Long`].
    Long(Long),
    /// See [`Bob`].
    Bob(Bob),
    /// See [`Curly`].
    Curly(Curly),
    /// See [`Short`].
    Short(Short),
}

impl Default for Style {
    fn default() -> Self {
        Self::Long(Long::default())
    }
}

impl FromStr for Style {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        match name.to_ascii_lowercase().as_str() {
            "long" => Ok(Self::Long(Long::default())),
            "bob" => Ok(Self::Bob(Bob::default())),
            "curly" => Ok(Self::Curly(Curly::default())),
            "short" => Ok(Self::Short(Short::default())),
            _ => Err(Error::Parameter {
                name: "style",
                value: name.to_owned(),
                range: "long, bob, curly or short",
            }),
        }
    }
}

impl Style {
    /// Names of styles that can be parsed.
    pub const NAMES: [&'static str; 4] = ["long", "bob", "curly", "short"];

    /// Returns the name of the style.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Long(_) => "long",
            Self::Bob(_) => "bob",
            Self::Curly(_) => "curly",
            Self::Short(_) => "short",
        }
    }

    /// Returns the style with another seed.
    pub fn with_seed(mut self, new: u32) -> Self {
        match &mut self {
            Self::Long(Long { seed, .. })
            | Self::Bob(Bob { seed, .. })
            | Self::Curly(Curly { seed, .. })
            | Self::Short(Short { seed, .. }) => *seed = new,
        }
        self
    }

    /// Returns the recipe of the style.
    pub fn recipe(&self) -> Recipe {
        let base = Recipe {
            guides: 166,
            seed: 1,
            hairline_raise: 0.0,
            hairline_irregularity: 0.002,
            parting: Some(0.022),
            parting_half_width: 0.0006,
            parting_wander: 0.0012,
            length: LowTop::new(0.24, 0.32),
            shortest: 0.12,
            hem: Some(0.1),
            hem_softness: 0.012,
            lift: LowTop::new(0.35, 0.85),
            volume: LowTop::new(0.005, 0.018),
            back: 0.25,
            forward: 0.0,
            gravity: 0.9,
            bend: 0.016,
            wave: 0.006,
            wavelength: 0.115,
            tip_in: 0.0,
            tousle: 0.06,
            fringe: false,
            stiffness: LowTop::new(1.0, 1.0),
            hold: Hold { bending: 6.0, root: 1200.0, tip: 60.0 },
        };
        match *self {
            Self::Long(Long { guides, seed, length, parting, wave }) => Recipe {
                guides,
                seed,
                parting: Some(parting),
                length: LowTop::new(length * 0.75, length),
                wave,
                ..base
            },
            Self::Bob(Bob { guides, seed, edge, parting, fringe }) => Recipe {
                guides,
                seed,
                parting: Some(parting),
                length: LowTop::new(0.2, 0.28),
                shortest: 0.035,
                hem: Some(-edge),
                hem_softness: 0.005,
                volume: LowTop::new(0.006, 0.017),
                wave: 0.001,
                wavelength: 0.12,
                tip_in: 0.8,
                tousle: 0.03,
                back: 0.2,
                fringe,
                stiffness: LowTop::new(1.5, 1.5),
                ..base
            },
            Self::Curly(Curly { guides, seed, length, .. }) => Recipe {
                guides,
                seed,
                parting: Some(-0.018),
                parting_half_width: 0.0,
                parting_wander: 0.009,
                length: LowTop::new(length * 0.7, length),
                shortest: 0.1,
                hem: None,
                lift: LowTop::new(0.7, 1.05),
                volume: LowTop::new(0.016, 0.034),
                gravity: 1.0,
                bend: 0.022,
                wave: 0.004,
                wavelength: 0.07,
                tousle: 0.3,
                stiffness: LowTop::new(1.5, 1.5),
                ..base
            },
            Self::Short(Short { guides, seed, top, sides }) => Recipe {
                guides,
                seed,
                parting: None,
                length: LowTop::new(sides, top),
                shortest: sides.min(top) * 0.8,
                hem: None,
                lift: LowTop::new(0.35, 0.8),
                volume: LowTop::new(0.004, 0.022),
                back: 0.0,
                forward: 0.7,
                gravity: 0.5,
                bend: 0.026,
                wave: 0.0015,
                wavelength: 0.04,
                tousle: 0.3,
                stiffness: LowTop::new(4.0, 2.5),
                ..base
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn style_names_round_trip() {
        for name in Style::NAMES {
            assert_eq!(name.parse::<Style>().unwrap().name(), name);
        }
        assert!("mullet".parse::<Style>().is_err());
        assert_eq!(Style::default().recipe().guides, 166);
        assert_eq!(Style::default().with_seed(9).recipe().seed, 9);
    }
}
