//! What a user sets of the level of detail.

use crate::{Result, groom::range, range::Range};

/// How the level of detail is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LodMode {
    /// Full detail at any distance.
    Off,
    /// By the size of a pixel at the hair.
    #[default]
    Auto,
    /// This share of the strands at any distance, above 0 and at most 1, and segments to suit.
    Fixed(f32),
}

/// Level of detail, as a user sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LodOptions {
    /// How it is chosen.
    pub mode: LodMode,
    /// 1 draws as if the hair were twice as far away, -1 half as far; -8 to 8.
    pub bias: f32,
    /// Strands are left out until the others are this wide, pixels.
    pub strand_width: f32,
    /// How far strands may stray from their full shape, pixels.
    pub curve_error: f32,
    /// The largest factor on the length of a fixed step, 1 to 4; 1 keeps the rate at any distance.
    pub slowest: f32,
    /// The size of a pixel from which on steps grow, metres; at twice that they are twice as long.
    pub slow_pixel: f32,
    /// Guides are left out until those that are simulated are so far from others, pixels; these are led. 0 simulates all.
    pub guides: f32,
    /// The size of a pixel at which half the substeps do, metres; at twice that a quarter. 0 keeps them.
    pub substep_pixel: f32,
    /// The size of a pixel from which on hair feels less of other hair, metres; from twice that on nothing. 0 for never.
    pub alone_pixel: f32,
    /// Whether hair that has come to rest, or that is out of view, is left as it is.
    pub sleep: bool,
}

impl Default for LodOptions {
    fn default() -> Self {
        Self {
            mode: LodMode::Auto,
            bias: 0.0,
            strand_width: 0.2,
            curve_error: 0.15,
            slowest: 2.0,
            slow_pixel: 3e-3,
            guides: 0.0,
            substep_pixel: 0.0,
            alone_pixel: 0.0,
            sleep: false,
        }
    }
}

impl LodOptions {
    /// For one head of many: strands are half as wide again and stray twice as far, and the motion has levels of detail
    /// as well.
    pub const CROWD: Self = Self {
        mode: LodMode::Auto,
        bias: 0.0,
        strand_width: 0.3,
        curve_error: 0.3,
        slowest: 2.0,
        slow_pixel: 3e-3,
        guides: 3.0,
        substep_pixel: 3e-3,
        alone_pixel: 4e-3,
        sleep: true,
    };
    /// The range of the share of [`LodMode::Fixed`].
    pub const FRACTION: Range = range!("share of the strands", 0.0001 to 1.0);
    /// The range of [`bias`](Self::bias).
    pub const BIAS: Range = range!("bias of the level of detail", -8.0 to 8.0);
    /// The range of [`strand_width`](Self::strand_width).
    pub const STRAND_WIDTH: Range = range!("least strand width", 0.001 to 10.0, "pixels");
    /// The range of [`curve_error`](Self::curve_error).
    pub const CURVE_ERROR: Range = range!("curve error", 0.0 to 100.0, "pixels");
    /// The range of [`slowest`](Self::slowest).
    pub const SLOWEST: Range = range!("slowest step", 1.0 to 4.0);
    /// The range of [`slow_pixel`](Self::slow_pixel).
    pub const SLOW_PIXEL: Range = range!("pixel of slower steps", 1e-6 to 10.0, "m"; usually 1e-6 to 1.0);

    /// The range of [`guides`](Self::guides).
    pub const GUIDES: Range = range!("reach of guides", 0.0 to 100.0, "pixels");
    /// The range of [`substep_pixel`](Self::substep_pixel).
    pub const SUBSTEP_PIXEL: Range = range!("pixel of fewer substeps", 0.0 to 10.0, "m"; usually 0.0 to 1.0);
    /// The range of [`alone_pixel`](Self::alone_pixel).
    pub const ALONE_PIXEL: Range = range!("pixel of hair alone", 0.0 to 10.0, "m"; usually 0.0 to 1.0);

    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) names the first that is not.
    pub fn check(&self) -> Result<()> {
        if let LodMode::Fixed(fraction) = self.mode {
            Self::FRACTION.check(fraction)?;
        }
        Self::BIAS.check(self.bias)?;
        Self::STRAND_WIDTH.check(self.strand_width)?;
        Self::CURVE_ERROR.check(self.curve_error)?;
        Self::SLOWEST.check(self.slowest)?;
        Self::GUIDES.check(self.guides)?;
        Self::SUBSTEP_PIXEL.check(self.substep_pixel)?;
        Self::ALONE_PIXEL.check(self.alone_pixel)?;
        Ok(Self::SLOW_PIXEL.check(self.slow_pixel)?)
    }
}
