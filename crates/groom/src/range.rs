//! The ranges of parameters: a constant beside the field, which its check and every interface name.

use crate::{Error, Result};

/// What a parameter may be, both ends included, in SI units. [`range!`](crate::range!) makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// What errors call the parameter.
    pub name: &'static str,
    /// The smallest value that works.
    pub least: f64,
    /// The largest.
    pub most: f64,
    /// The part of it that interfaces offer: what makes sense for hair.
    pub usual: [f64; 2],
    words: &'static str,
}

impl Range {
    /// From `least` to `most`, which `words` say.
    pub const fn new(name: &'static str, least: f64, most: f64, words: &'static str) -> Self {
        Self { name, least, most, usual: [least, most], words }
    }

    /// Interfaces offer this part of it.
    pub const fn usually(mut self, least: f64, most: f64) -> Self {
        self.usual = [least, most];
        self
    }

    /// Whether `value` is a number within the range.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it is not.
    pub fn check(&self, value: f32) -> Result<()> {
        Error::unless_within(self.name, value, self.least as f32, self.most as f32, self.words)
    }

    /// `value` brought into the range; a value that is no number stays one.
    pub fn clamp(&self, value: f32) -> f32 {
        value.clamp(self.least as f32, self.most as f32)
    }
}

/// A [`Range`](crate::range::Range): its name, both ends as literals, their unit, and what is usual.
///
/// ```
/// use tresses_groom::{range, range::Range};
/// const DRAG: Range = range!("drag", 0.0 to 1e4, "1/s"; usually 0.0 to 100.0);
/// assert!(DRAG.check(500.0).is_ok() && DRAG.usual[1] == 100.0);
/// assert_eq!(DRAG.check(-1.0).unwrap_err().to_string(), "drag is -1, but must be from 0.0 to 1e4 1/s");
/// ```
#[macro_export]
macro_rules! range {
    ($name:literal, $least:literal to $most:literal $(, $unit:literal)? $(; usually $from:literal to $to:literal)?) => {
        $crate::range::Range::new(
            $name,
            $least,
            $most,
            concat!("from ", stringify!($least), " to ", stringify!($most) $(, " ", $unit)?),
        )
        $(.usually($from, $to))?
    };
}
