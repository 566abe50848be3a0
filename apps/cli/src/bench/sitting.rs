//! Settings of all measurements of one run.

use indicatif::ProgressBar;
use tresses::low_level::Clock;

/// Settings of all measurements of one run.
#[derive(Clone, Copy)]
pub struct Sitting<'a> {
    /// Measured frames per scene.
    pub frames: u32,
    /// Clock for times on the CPU.
    pub clock: Clock,
    /// Progress bar; advances by one per measured frame.
    pub bar: &'a ProgressBar,
}
