//! Ranges of parameters: constants beside the fields, shared by their checks and by every interface.

use crate::{Error, Result};

/// Range of a parameter, both ends included, in SI units. [`range!`](crate::range!) creates one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Name of the parameter in errors.
    pub name: &'static str,
    /// Smallest valid value.
    pub min: f64,
    /// Largest valid value.
    pub max: f64,
    /// Part of the range that interfaces offer because it makes sense for hair.
    pub typical: [f64; 2],
    words: &'static str,
}

impl Range {
    /// Creates a range from `min` to `max`; `words` is its text.
    pub const fn new(name: &'static str, min: f64, max: f64, words: &'static str) -> Self {
        Self { name, min, max, typical: [min, max], words }
    }

    /// Sets the part of the range that interfaces offer.
    pub const fn usually(mut self, min: f64, max: f64) -> Self {
        self.typical = [min, max];
        self
    }

    /// Checks that `value` is a number within the range.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it is not.
    pub fn check(&self, value: f32) -> Result<()> {
        Error::unless_within(self.name, value, self.min as f32, self.max as f32, self.words)
    }

    /// Clamps `value` to the range; NaN stays NaN.
    pub fn clamp(&self, value: f32) -> f32 {
        value.clamp(self.min as f32, self.max as f32)
    }
}

/// Creates a [`Range`](crate::range::Range) from its name, both ends as literals, their unit, and the usual part.
///
/// ```
/// use tresses_groom::{range, range::Range};
/// const DRAG: Range = range!("drag", 0.0 to 1e4, "1/s"; usually 0.0 to 100.0);
/// assert!(DRAG.check(500.0).is_ok() && DRAG.typical[1] == 100.0);
/// assert_eq!(DRAG.check(-1.0).unwrap_err().to_string(), "drag is -1, but must be from 0.0 to 1e4 1/s");
/// ```
#[macro_export]
macro_rules! range {
    ($name:literal, $min:literal to $max:literal $(, $unit:literal)? $(; usually $from:literal to $to:literal)?) => {
        $crate::range::Range::new(
            $name,
            $min,
            $max,
            concat!("from ", stringify!($min), " to ", stringify!($max) $(, " ", $unit)?),
        )
        $(.usually($from, $to))?
    };
}
