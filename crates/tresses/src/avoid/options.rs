//! User parameters of strand collision.

use crate::{Result, groom::range, range::Range};

/// Handling of drawn strands that enter an obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AvoidMode {
    /// Strands may penetrate.
    Off,
    /// Each penetrating vertex is moved out separately: the strand has a kink at the obstacle and continues behind it
    /// as if it were not there. For comparison.
    PenetratingOnly,
    /// The strand changes over to the clump around its nearest guide.
    #[default]
    ChangeOver,
}

/// Options of strand collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AvoidOptions {
    /// Handling of penetrating strands.
    pub mode: AvoidMode,
    /// Depth below its clearance from which a vertex counts as penetrating, meters.
    pub tolerance: f32,
    /// Length of hair before the first hit over which a strand changes over, meters; at most half of the strand.
    pub zone: f32,
    /// Contraction of a clump: 0 for none, 1 onto its guide.
    pub tightness: f32,
    /// Time in which a strand changes over, s; 0 for immediately.
    pub fade_in: f32,
    /// Time in which a strand changes back after its last hit, s.
    pub fade_out: f32,
    /// Speed at which the change-over follows the first hit along the strand, m/s.
    pub speed: f32,
}

impl Default for AvoidOptions {
    fn default() -> Self {
        Self {
            mode: AvoidMode::ChangeOver,
            tolerance: 3e-4,
            zone: 0.05,
            tightness: 0.3,
            fade_in: 0.3,
            fade_out: 0.6,
            speed: 0.25,
        }
    }
}

impl AvoidOptions {
    /// The range of [`tolerance`](Self::tolerance).
    pub const TOLERANCE: Range = range!("strand collision tolerance", 0.0 to 0.1, "m"; usually 0.0 to 0.01);
    /// The range of [`zone`](Self::zone).
    pub const ZONE: Range = range!("strand collision blend length", 0.0 to 10.0, "m"; usually 0.0 to 0.5);
    /// The range of [`tightness`](Self::tightness).
    pub const TIGHTNESS: Range = range!("strand collision tightness", 0.0 to 1.0);
    /// The range of [`fade_in`](Self::fade_in) and [`fade_out`](Self::fade_out).
    pub const FADE: Range = range!("strand collision fade time", 0.0 to 100.0, "s"; usually 0.0 to 5.0);
    /// The range of [`speed`](Self::speed).
    pub const SPEED: Range =
        Range::new("strand collision speed", 0.0, f64::INFINITY, "0 m/s or more").usually(0.0, 10.0);

    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter).
    pub fn check(&self) -> Result<()> {
        Self::TOLERANCE.check(self.tolerance)?;
        Self::ZONE.check(self.zone)?;
        Self::TIGHTNESS.check(self.tightness)?;
        Self::FADE.check(self.fade_in)?;
        Self::FADE.check(self.fade_out)?;
        Ok(Self::SPEED.check(self.speed)?)
    }

    /// Returns the changes per frame of `dt` seconds: rise and fall of the amount (the mean of two frames counts, so 2
    /// is immediate), and motion along the strand, meters.
    pub(super) fn per_frame(&self, dt: f32) -> [f32; 3] {
        let dt = if dt.is_finite() { dt.max(0.0) } else { 0.0 };
        let fade = |time: f32| if time > 0.0 { (dt / time).min(2.0) } else { 2.0 };
        let shift = if self.speed.is_finite() { self.speed * dt } else { f32::MAX };
        [fade(self.fade_in), fade(self.fade_out), shift]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_values_return_errors() {
        assert!(AvoidOptions::default().check().is_ok());
        assert!(AvoidOptions { speed: f32::INFINITY, ..Default::default() }.check().is_ok());
        for wrong in [
            AvoidOptions { tightness: 1.1, ..Default::default() },
            AvoidOptions { zone: -1.0, ..Default::default() },
            AvoidOptions { tolerance: f32::NAN, ..Default::default() },
            AvoidOptions { speed: f32::NAN, ..Default::default() },
        ] {
            assert!(wrong.check().unwrap_err().to_string().contains("strand collision"));
        }
    }

    #[test]
    fn change_per_frame_is_proportional_to_time() {
        let options = AvoidOptions { fade_in: 0.1, fade_out: 0.0, speed: 0.5, ..Default::default() };
        let [rise, fall, shift] = options.per_frame(0.02);
        assert!((rise - 0.2).abs() < 1e-6 && fall == 2.0 && (shift - 0.01).abs() < 1e-6);
        assert_eq!(options.per_frame(f32::NAN)[0], 0.0);
        assert_eq!(options.per_frame(-1.0)[2], 0.0);
        assert_eq!(options.per_frame(9.0)[0], 2.0);
    }
}
