//! User options of the level of detail.

use crate::{Result, groom::range, range::Range};

/// How the level of detail is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LodMode {
    /// Full detail at any distance.
    Off,
    /// Chosen by the size of a pixel at the hair.
    #[default]
    Auto,
    /// A fixed share of the strands at any distance, above 0 and at most 1, with a matching number of segments.
    Fixed(f32),
}

/// Options of the level of detail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LodOptions {
    /// How the level is chosen.
    pub mode: LodMode,
    /// Bias in octaves: 1 draws as if the hair were twice as far away, -1 half as far. From -8 to 8.
    pub bias: f32,
    /// Width to which the remaining strands are widened as others are dropped, pixels.
    pub strand_width: f32,
    /// Maximum deviation of strands from their full shape, pixels.
    pub curve_error: f32,
    /// Maximum factor on the length of a fixed step, 1 to 4; 1 keeps the rate at any distance.
    pub slowest: f32,
    /// Pixel size above which steps grow, meters; at twice that size they are twice as long.
    pub slow_pixel: f32,
    /// Maximum distance of a dropped guide from the simulated guide that it follows, pixels; 0 simulates all guides.
    pub guides: f32,
    /// Pixel size at which substeps are halved, meters; at twice that size they are quartered. 0 keeps them.
    pub substep_pixel: f32,
    /// Pixel size at which self-collision begins to fade, meters; it is off at twice that size. 0 keeps it.
    pub collision_pixel: f32,
    /// Whether hair at rest or out of view sleeps.
    pub can_sleep: bool,
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
            collision_pixel: 0.0,
            can_sleep: false,
        }
    }
}

impl LodOptions {
    /// For crowds: strands are 1.5 times as wide, deviate twice as far, and the motion has levels of detail as well.
    pub const CROWD: Self = Self {
        mode: LodMode::Auto,
        bias: 0.0,
        strand_width: 0.3,
        curve_error: 0.3,
        slowest: 2.0,
        slow_pixel: 3e-3,
        guides: 3.0,
        substep_pixel: 3e-3,
        collision_pixel: 4e-3,
        can_sleep: true,
    };
    /// The range of the share of [`LodMode::Fixed`].
    pub const FRACTION: Range = range!("fraction of the strands", 0.0001 to 1.0);
    /// The range of [`bias`](Self::bias).
    pub const BIAS: Range = range!("bias of the level of detail", -8.0 to 8.0);
    /// The range of [`strand_width`](Self::strand_width).
    pub const STRAND_WIDTH: Range = range!("minimum strand width", 0.001 to 10.0, "pixels");
    /// The range of [`curve_error`](Self::curve_error).
    pub const CURVE_ERROR: Range = range!("curve error", 0.0 to 100.0, "pixels");
    /// The range of [`slowest`](Self::slowest).
    pub const SLOWEST: Range = range!("maximum step factor", 1.0 to 4.0);
    /// The range of [`slow_pixel`](Self::slow_pixel).
    pub const SLOW_PIXEL: Range =
        range!("pixel size for longer steps", 1e-6 to 10.0, "m"; usually 1e-6 to 1.0);

    /// The range of [`guides`](Self::guides).
    pub const GUIDES: Range = range!("guide distance", 0.0 to 100.0, "pixels");
    /// The range of [`substep_pixel`](Self::substep_pixel).
    pub const SUBSTEP_PIXEL: Range =
        range!("pixel size for fewer substeps", 0.0 to 10.0, "m"; usually 0.0 to 1.0);
    /// The range of [`collision_pixel`](Self::collision_pixel).
    pub const COLLISION_PIXEL: Range =
        range!("pixel size without self-collision", 0.0 to 10.0, "m"; usually 0.0 to 1.0);

    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) with the first value that is out of range.
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
        Self::COLLISION_PIXEL.check(self.collision_pixel)?;
        Ok(Self::SLOW_PIXEL.check(self.slow_pixel)?)
    }
}
